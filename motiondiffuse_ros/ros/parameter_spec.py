"""Parameters with a meaning, a unit and limits, declared on a node and guarded by it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    SetParametersResult,
)
from rclpy.node import Node
from rclpy.parameter import Parameter


@dataclass(frozen=True)
class ParameterSpec:
    """One parameter.

    Attributes:
        default: Also fixes the type.
        description: For `ros2 param describe`, with the unit.
        bounds: Least and greatest value of a number.
        choices: Valid values of a string; empty = any.
        check: Says what is wrong with a value beyond that; empty = nothing.
        at_configure: Read by `configure` alone, so it cannot be changed while configured.
    """

    default: bool | int | float | str
    description: str
    bounds: tuple[float, float] | None = None
    choices: tuple[str, ...] = ()
    at_configure: bool = False
    check: Callable[[str], str] | None = None

    def descriptor(self) -> ParameterDescriptor:
        """Return the descriptor that makes rclpy refuse values out of bounds."""
        descriptor = ParameterDescriptor(
            description=self.description,
            additional_constraints="one of " + ", ".join(self.choices) if self.choices else "",
        )
        if self.bounds is not None and isinstance(self.default, float):
            low, high = self.bounds
            descriptor.floating_point_range = [FloatingPointRange(from_value=low, to_value=high)]
        elif self.bounds is not None:
            low, high = (int(bound) for bound in self.bounds)
            descriptor.integer_range = [IntegerRange(from_value=low, to_value=high, step=1)]
        return descriptor

    def explain(self) -> str:
        """Return the description with choices, bounds and default, for a help text."""
        limits = ""
        if self.choices:
            limits = f" ({', '.join(self.choices)})"
        elif self.bounds is not None:
            limits = f" ({self.bounds[0]:g} to {self.bounds[1]:g})"
        default = str(self.default).lower() if isinstance(self.default, bool) else self.default
        return f"{self.description}{limits}; default {default!r}".replace("'", "")

    def refusal(self, value: object) -> str:
        """Return what is wrong with a value beyond its type and bounds; empty = nothing."""
        if self.choices and value not in self.choices:
            return f"it is one of {', '.join(self.choices)}"
        if self.check is not None and isinstance(value, str):
            return self.check(value)
        if isinstance(value, float) and not math.isfinite(value):
            return "it is a finite number"
        return ""


class Parameters:
    """The parameters of one node."""

    def __init__(self, node: Node, specs: Mapping[str, ParameterSpec]) -> None:
        """Declare all.

        Raises:
            InvalidParameterValueException: If an override is out of bounds or not a choice.
        """
        self._node, self._specs = node, specs
        self.locked = False
        node.add_on_set_parameters_callback(self._check)
        for name, spec in specs.items():
            node.declare_parameter(name, spec.default, spec.descriptor())

    def __getitem__(self, name: str) -> Any:
        """Return the present value."""
        return self._node.get_parameter(name).value

    def _check(self, parameters: list[Parameter]) -> SetParametersResult:
        for parameter in parameters:
            spec = self._specs.get(parameter.name)
            if spec is None:  # rclpy's own, such as use_sim_time
                continue
            if reason := spec.refusal(parameter.value):
                return _refused(f"{parameter.name} is '{parameter.value}'; {reason}")
            if spec.at_configure and self.locked:
                return _refused(f"{parameter.name} is read by configure; change it after cleanup")
        return SetParametersResult(successful=True)


def _refused(reason: str) -> SetParametersResult:
    return SetParametersResult(successful=False, reason=reason)
