"""What can go wrong, with the text that the command line prints."""


class Error(Exception):
    """Anything that this package refuses; the text names the cause, the numbers and what to do."""


class ConfigError(Error, ValueError):
    """A config, a patch or an experiment that cannot be read or is not sound. The text names file, line and key."""


class LogError(Error, ValueError):
    """A log that cannot be read. The text names file, place and what is there."""


class RecordingError(Error, ValueError):
    """Rows that are no recording of a rig. The text names the first row that is wrong."""


class UsageError(Error, ValueError):
    """Options that do not exist, or that exclude each other."""


class MissingLibraryError(Error, ImportError):
    """A library that is not installed. The text names the extra of the package that brings it."""


class ArgumentError(Error, ValueError):
    """Arrays that are no columns of numbers. The text names the argument."""
