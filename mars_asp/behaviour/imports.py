"""Files of behaviours: each folder's are imported for one run, and seen by its own code alone."""

import importlib
import sys
import sysconfig
from collections.abc import Iterator
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from traceback import walk_tb
from types import ModuleType, TracebackType
from typing import Any

#: Code that is not the user's: ours, Python's own, and what is installed.
FOREIGN = tuple(
    f"{path}/"
    for path in {
        Path(__file__).parents[1].as_posix(),
        *(sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")),
    }
)


_OURS = "mars_asp"


class Folder:
    """The Python modules of a folder, which its files can import while their code runs.

    Within a `with` block, modules of the folder are found before others of their names, except
    those of Python itself and of `mars-asp`. After the block, none of them is in `sys.modules`, so
    that neither other folders nor later runs see them.
    """

    def __init__(self, path: Path) -> None:
        importlib.invalidate_caches()  # files may be new
        self.path = path
        self.names = frozenset(_module_names(path))
        self.modules: dict[str, ModuleType] = {}
        self._aside: dict[str, ModuleType] = {}
        self._sought = False
        self._depth = 0

    def load(self, path: Path, **given: Any) -> ModuleType:
        """Return the module of a file, executed once; `given` is put in it before.

        Raises:
            ImportError: it is not a Python file.
            Exception: whatever executing it raises.
        """
        name = ".".join(path.relative_to(self.path).with_suffix("").parts)
        name = name.removesuffix(".__init__")
        if name.partition(".")[0] not in self.names:
            name = f"_behaviour_{name}"  # another module has its name
        with self:
            there = sys.modules.get(name)
            if there is not None and there.__file__ == str(path):
                return there
            if "." in name:
                importlib.import_module(name.rpartition(".")[0])
            specification = spec_from_file_location(name, path)
            if specification is None or specification.loader is None:
                raise ImportError("it is not a Python file")
            module = self.modules[name] = sys.modules[name] = module_from_spec(specification)
            vars(module).update(given)
            try:
                specification.loader.exec_module(module)
            except BaseException:
                self.modules.pop(name, None)
                sys.modules.pop(name, None)
                raise
            return module

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        """Return the spec of a module in the folder, or None; a finder of `sys.meta_path`."""
        if name.partition(".")[0] not in self.names:
            return None
        self._sought = True
        if path is not None:
            return None  # in a package, which knows its folder
        return PathFinder.find_spec(name, [str(self.path)])

    def __enter__(self) -> "Folder":
        self._depth += 1
        if self._depth == 1:
            loaded = sys.modules
            if clash := loaded.keys() & self.names:
                self._aside = {n: m for n, m in loaded.items() if n.partition(".")[0] in clash}
                for name in self._aside:
                    del loaded[name]
            loaded.update(self.modules)
            sys.meta_path.insert(0, self)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._depth -= 1
        if self._depth:
            return
        loaded = sys.modules
        sys.meta_path.remove(self)
        if self._sought:
            self._sought = False
            own = {n: m for n, m in loaded.items() if n.partition(".")[0] in self.names}
            self.modules.update(own)
        for name in self.modules:
            loaded.pop(name, None)
        if self._aside:
            loaded.update(self._aside)
            self._aside = {}


def folder_of(path: Path) -> Path:
    """Return the folder from which a file's modules are imported: above its packages."""
    folder = path.parent
    while (folder / "__init__.py").is_file() and folder.name.isidentifier():
        folder = folder.parent
    return folder


def place_of(error: BaseException) -> tuple[str, int] | None:
    """Return file and line of the innermost frame of an exception in the user's code, or None."""
    if isinstance(error, SyntaxError) and error.filename and error.lineno:
        return error.filename, error.lineno
    found = None
    for frame, line in walk_tb(error.__traceback__):
        path = frame.f_code.co_filename
        if not path.startswith((*FOREIGN, "<")):
            found = path, line
    if found is None and error.__context__ is not None:
        # What ended the program in the place of an exception is its context.
        return place_of(error.__context__)
    return found


def _module_names(folder: Path) -> Iterator[str]:
    """Yield the modules that are imported from the files and folders of a folder."""
    for entry in folder.iterdir():
        name = entry.stem if entry.suffix == ".py" else entry.name
        is_ours = name in sys.stdlib_module_names or name == _OURS
        if not name.isidentifier() or is_ours or not (entry.suffix == ".py" or entry.is_dir()):
            continue
        if entry.is_dir() and not (entry / "__init__.py").is_file():
            # As in Python, a folder that is not a package gives way to a module of its name.
            elsewhere = PathFinder.find_spec(name)
            if elsewhere is not None and elsewhere.loader is not None:
                continue
        yield name
