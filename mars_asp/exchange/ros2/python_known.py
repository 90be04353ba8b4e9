"""What the functions return that launch files in Python call: texts, paths and lists."""

from mars_asp.exchange.ros2.actions import (
    UNKNOWN,
    LaunchArgument,
    LaunchDirectory,
    PackageShare,
    plain,
)
from mars_asp.exchange.ros2.python_values import (
    Listed,
    MappedValue,
    Plain,
    PythonCall,
    PythonFile,
    Rewritten,
    Value,
    counted,
    folder_of,
    items_of,
    path_of,
    text_from,
)

#: Functions that return one of their arguments as a path.
_PATHS = frozenset(
    {"abspath", "realpath", "normpath", "expanduser", "Path", "str", "PathSubstitution"}
    | {"FileContent"}
)
_SHARES = frozenset(
    {
        "get_package_share_directory",
        "get_package_share_path",
        "FindPackageShare",
        "FindPackage",
        "FindPackagePrefix",
    }
)


def known(call: PythonCall) -> Value:  # noqa: C901 -- one case for each function
    """Return the text that a call makes, where it makes one; else the call itself."""
    first = call.arguments[0] if call.arguments else None
    match call.name:
        case "LaunchDescription":
            entities = call.get("initial_entities", 0)
            copy = Listed(list(items_of(entities)), call.span)
            return PythonCall(call.name, (copy,), {}, call.span)
        case "LaunchConfiguration" | "LaunchConfigAsBool":
            name = plain(text_from(call.get("variable_name", 0)))
            default = call.named.get("default")
            if name is None:
                return Plain(UNKNOWN, call.span)
            text = None if default is None else text_from(default)
            return Plain((LaunchArgument(name, text),), call.span)
        case "TextSubstitution":
            return Plain(text_from(call.get("text", 0)), call.span)
        case "ThisLaunchFileDir":
            return Plain((LaunchDirectory(),), call.span)
        case "EnvironmentVariable" | "getenv":
            called = plain(text_from(call.get("name", 0)))
            value = call.get("default_value", 1)
            otherwise = None if value is None else text_from(value)
            return Plain((LaunchArgument(f"env {called}", otherwise),), call.span)
        case "PathJoinSubstitution" | "PathJoin":
            parts = items_of(first) if isinstance(first, Listed) else call.arguments
            return Plain(path_of(*map(text_from, parts)), call.span)
        case "join":
            return Plain(path_of(*map(text_from, call.arguments)), call.span)
        case "dirname":
            return Plain(folder_of(text_from(first)), call.span)
        case "open" | "safe_load" | "full_load" | "load":
            # Of a file of parameters it is enough to know which.
            return PythonFile(
                first.text if isinstance(first, PythonFile) else text_from(first), call.span
            )
        case "ParameterFile":
            file = call.get("param_file", 0)
            return file if isinstance(file, Rewritten) else Plain(text_from(file), call.span)
        case "RewrittenYaml":
            rewrites = call.get("param_rewrites", 1)
            given = rewrites if isinstance(rewrites, MappedValue) else MappedValue(())
            return Rewritten(text_from(call.get("source_file", 0)), given, call.span)
        case "ReplaceString":
            return Plain(text_from(call.get("source_file", 0)), call.span)
        case "ParameterValue":
            return call.get("value", 0)
        case "list" | "tuple" | "sorted" | "reversed":
            return first
        case "range" | "enumerate" | "zip":
            return counted(call)
        case "dict":
            pairs = tuple((Plain((key,), call.span), value) for key, value in call.named.items())
            return MappedValue((*(first.pairs if isinstance(first, MappedValue) else ()), *pairs))
        case name if name in _SHARES:
            return Plain((PackageShare(text_from(call.get("package", 0))),), call.span)
        case name if name in _PATHS:
            return Plain(path_of(*map(text_from, call.arguments)), call.span)
        case _:
            return call
