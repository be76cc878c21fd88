"""Libraries that come with an extra of the package: where one is missing, the error names the extra."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from .errors import MissingLibraryError

#: Modules that each extra brings.
_MODULES = {
    "fleet": ("dask", "distributed", "fsspec", "pyarrow", "scipy"),
    "mat": ("scipy",),
    "s3": ("s3fs",),
    "slurm": ("dask_jobqueue",),
}


@contextmanager
def extra(*names: str) -> Iterator[None]:
    """Around code, or over a function, that needs the libraries of these extras. Other modules are not its matter."""
    try:
        yield
    except ImportError as error:
        module = (error.name or "").partition(".")[0]
        bringing = [name for name in names if module in _MODULES[name]]
        if not isinstance(error, ModuleNotFoundError) or not bringing:
            raise
        raise MissingLibraryError(
            f"{module} is not installed; it comes with: pip install airball[{bringing[0]}]", name=module
        ) from None
