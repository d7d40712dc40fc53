"""`motiondiffuse`: the command line. Commands are imported when they are called."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from importlib import import_module

from motiondiffuse_ros.errors import Cancelled, InputError, MotionDiffuseError

# name -> (what it does, module, function taking the remaining arguments)
COMMANDS: dict[str, tuple[str, str, str]] = {
    "generate": ("words or a request file to a checked trajectory", "generate", "main"),
    "replay": ("plan again what was recorded, and compare bit for bit", "replay", "main"),
    "check": ("physics verdict on a BVH or npz file", "check", "main"),
    "corpus": ("build a training corpus; fetch NAME tells where originals are", "corpus", "main"),
    "train": ("train a denoiser on a corpus", "train", "main"),
    "distill": ("teach a denoiser to need few steps", "distill", "main"),
    "evaluate": ("the paper's tables for a set of weights", "evaluate", "main"),
    "train-evaluator": ("train the ruler that evaluate uses", "train_evaluator", "main"),
    "node": ("the ROS 2 lifecycle node", "node", "node_main"),
    "sim": ("a simulated robot that follows the node", "sim", "run_sim"),
    "demo": ("node, sim and a text goal as real processes", "demo", "main"),
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command.

    Returns:
        0 on success, 2 for bad input (one line on stderr), 1 for other failures, 130 if
        interrupted.
    """
    given = list(sys.argv[1:] if arguments is None else arguments)
    if not given or given[0] in ("-h", "--help"):
        print(_usage())
        return 0 if given else 2
    name, *rest = given
    if name == "--version":
        print(import_module("motiondiffuse_ros").__version__)
        return 0
    if name not in COMMANDS:
        return _fail(f"unknown command '{name}'; the commands are {', '.join(COMMANDS)}", 2)
    _, module, function = COMMANDS[name]
    try:
        command: Callable[[Sequence[str]], int] = getattr(
            import_module(f"motiondiffuse_ros.cli.{module}"), function
        )
        return command(rest)
    except InputError as error:
        return _fail(str(error), 2)
    except (KeyboardInterrupt, Cancelled):
        return _fail("interrupted", 130)
    except MotionDiffuseError as error:
        return _fail(str(error), 1)


def _usage() -> str:
    width = max(map(len, COMMANDS))
    rows = [f"  {name:<{width}}  {summary}" for name, (summary, _, _) in COMMANDS.items()]
    return "\n".join(
        [
            "usage: motiondiffuse COMMAND ...",
            "",
            *rows,
            "",
            "motiondiffuse COMMAND --help says more",
        ]
    )


def _fail(message: str, code: int) -> int:
    print(f"motiondiffuse: {message}", file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
