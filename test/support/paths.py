"""Where things are in this repository."""

from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
CONFIG = ROOT / 'config'
MT2012 = CONFIG / 'mt2012.yaml'
