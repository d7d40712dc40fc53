# MuJoCo's names come from extension modules that pyright cannot read.
from typing import Any

def __getattr__(name: str) -> Any: ...
