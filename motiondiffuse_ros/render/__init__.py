"""Pictures of motions: a drawn figure that works everywhere, MuJoCo's renderer where GL is."""

from motiondiffuse_ros.render.skeleton_renderer import contact_sheet, render_skeleton

__all__ = ["contact_sheet", "render_skeleton"]
