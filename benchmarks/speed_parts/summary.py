"""The figures of speed.json in one table."""

from __future__ import annotations

from typing import Any


def summary_rows(record: dict[str, Any]) -> list[tuple[str, str, str]]:
    """Return what was measured, how much, and what is asked for."""
    plan = record["text_to_plan_s"]
    ten = record["ten_minutes_s"]
    return [
        (
            "sentence to checked plan, s",
            f"{plan['median']:.2f} (p95 {plan['p95']:.2f})",
            "0.5 (1.0)",
        ),
        ("sentence to first set-point, s", f"{record['first_setpoint_s']:.2f}", ""),
        *(
            (
                f"the same with {', '.join(f'{k}:={v}' for k, v in row['parameters'].items())}",
                f"{row['first_setpoint_s']:.2f}",
                "0.2" if "horizon" in row["parameters"] else "",
            )
            for row in record["streamed"]
        ),
        ("sampling, s", f"{record['sampling_s']:.3f}", ""),
        ("faster than the paper's, times", f"{record['ratio_to_paper']:.0f}", "300"),
        (
            "the same, paper's in our arithmetic",
            f"{record['ratio_to_paper_same_arithmetic']:.0f}",
            "",
        ),
        ("the same, paper's for one motion", f"{record['ratio_to_paper_one_motion']:.0f}", ""),
        (
            "sampling over its floor, times",
            f"{record['ratio_to_floor']:.1f} (floor {record['floor_s']:.3f} s)",
            "5",
        ),
        ("report, times real time", f"{record['report_realtime_factor']:.0f}", "50"),
        (
            "report and tracking, times real time",
            f"{record['report_with_tracking_realtime_factor']:.0f}",
            "",
        ),
        ("retargeting, times real time", f"{record['retarget_realtime_factor']:.0f}", ""),
        ("messages, times real time", f"{record['messages_realtime_factor']:.0f}", ""),
        ("start to first goal, s", f"{record['startup_s']:.1f}", "6"),
        (
            "memory of the node, MiB",
            f"{record['rss_mb']:.0f} (peak {record['rss_peak_mb']:.0f})",
            "1000",
        ),
        ("ten minutes of motion, s", "not measured" if ten is None else f"{ten:.0f}", "60"),
    ]
