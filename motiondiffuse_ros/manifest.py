"""Folders of weights: files of tensors, and a config.json that holds their hashes."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from hashlib import sha256
from importlib.resources import files as package_files
from pathlib import Path
from typing import Any, TypeVar

import torch
from safetensors import SafetensorError
from safetensors.torch import load_file, save_file

from motiondiffuse_ros.errors import CheckpointError
from motiondiffuse_ros.hashing import file_sha256

CONFIG_FILE = "config.json"

_Module = TypeVar("_Module", bound=torch.nn.Module)


def shipped(name: str) -> Path:
    """Return a folder of weights that comes with the package: base, cmu or evaluator."""
    return Path(str(package_files("motiondiffuse_ros"))) / "weights" / name


def write_manifest(folder: Path, config: dict[str, Any], files: Iterable[str]) -> None:
    """Write config.json: `config` and the SHA-256 of files of the folder."""
    hashes = {name: file_sha256(folder / name) for name in files}
    text = json.dumps({**config, "files": hashes}, indent=2)
    (folder / CONFIG_FILE).write_text(text + "\n", encoding="utf-8")


def read_manifest(
    folder: Path, *, what: str, format: int, fields: Iterable[str], files: Iterable[str]
) -> dict[str, Any]:
    """Read config.json and verify every file that it lists.

    Args:
        folder: Of the weights.
        what: Their kind, for messages.
        format: Value that its field `format` must have.
        fields: Further fields that it must have.
        files: Files that it must list.

    Raises:
        CheckpointError: If a file is missing, truncated, altered or of another format.
    """
    try:
        config = json.loads((folder / CONFIG_FILE).read_text(encoding="utf-8"))
    except OSError as error:
        raise CheckpointError(
            f"{what} {folder}: no {CONFIG_FILE}; it is a folder with "
            f"{', '.join((CONFIG_FILE, *files))}"
        ) from error
    except ValueError as error:
        raise CheckpointError(f"{what} {folder}: {CONFIG_FILE} is not JSON ({error})") from error
    wanted = {"format", "files", *fields}
    if not isinstance(config, dict) or not wanted <= set(config):
        raise CheckpointError(f"{what} {folder}: {CONFIG_FILE} needs {sorted(wanted)}")
    if config["format"] != format:
        raise CheckpointError(
            f"{what} {folder}: format {config['format']}, this version reads {format}"
        )
    if not set(files) <= set(config["files"]):
        raise CheckpointError(f"{what} {folder}: {CONFIG_FILE} gives no hashes of its files")
    for name, expected in config["files"].items():
        try:
            found = file_sha256(folder / name)
        except OSError as error:
            raise CheckpointError(f"{what} {folder}: {name} is missing") from error
        if found != expected:
            raise CheckpointError(
                f"{what} {folder}: {name} is truncated or altered "
                f"(SHA-256 {found[:12]}…, {CONFIG_FILE} says {expected[:12]}…)"
            )
    return config


def folder_hashes(folder: Path) -> dict[str, str]:
    """Return the SHA-256 of config.json and of the files that it lists, which were verified."""
    content = (folder / CONFIG_FILE).read_bytes()
    return {CONFIG_FILE: sha256(content).hexdigest(), **json.loads(content)["files"]}


def save_weights(module: torch.nn.Module, path: Path, dtype: torch.dtype = torch.float16) -> None:
    """Write a module's tensors in `dtype`."""
    tensors = {k: v.detach().to(dtype).contiguous() for k, v in module.state_dict().items()}
    save_file(tensors, path)


def load_weights(create: Callable[[], _Module], path: Path, *, what: str) -> _Module:
    """Return a module of stored tensors, in float32 and in evaluation mode.

    Args:
        create: Makes the module; its own values are not computed.
        path: Safetensors of its names.
        what: Kind of the weights, for messages.

    Raises:
        CheckpointError: If the file is not one of tensors of the module's names and shapes.
    """
    with torch.device("meta"):
        module = create()
    try:
        tensors = {k: v.float() for k, v in load_file(path).items()}
        module.load_state_dict(tensors, assign=True)
    except (OSError, SafetensorError, RuntimeError) as error:
        raise CheckpointError(
            f"{what} {path.parent}: {path.name} does not fit its {CONFIG_FILE} ({error})"
        ) from error
    return module.eval()
