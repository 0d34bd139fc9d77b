"""The thruster models, one file each: how a thruster loses thrust in a flow."""
