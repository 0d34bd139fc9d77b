"""What the tests share: vehicles, peers of the node, processes, and a second solver."""
