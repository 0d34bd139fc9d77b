"""What a tick costs, beside other ways to allocate: `python -m thrust_allocator.benchmark`."""
