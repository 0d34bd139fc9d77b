"""Coefficients of a thruster from its Bollard table and a few runs in a flow."""
