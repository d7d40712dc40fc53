"""The `motiondiffuse` command."""
