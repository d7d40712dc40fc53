"""Makes `synthetic` (motions made of sines) importable from every test folder."""
