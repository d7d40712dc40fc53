# MuJoCo's wheels bring no types for their compiled modules; without this pyright sees no MjModel.
from typing import Any

def __getattr__(name: str) -> Any: ...
