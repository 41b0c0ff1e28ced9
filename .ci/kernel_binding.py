"""Writes the prototypes of the compiled kernel and its binding to Python in C, from its declarations.

declared.h   struct of each record; prototype ``mbkf_<function>``, which the C body has to match
binding.h    ``py_<function>``, which checks arguments, makes results and calls the body; the module's table
"""

from __future__ import annotations

from collections.abc import Iterator

from kernel_declarations import ARRAYS, NAME, ORDERS, SCALARS, Declarations, Function, Value

MADE = "/* Made from the declarations in mbkf/kernel by .ci/kernel_binding.py. */"


def header(found: Declarations) -> str:
    """``declared.h``."""
    lines = [
        MADE,
        "#ifndef MBKF_DECLARED_H",
        "#define MBKF_DECLARED_H",
        "",
        *(f"typedef struct {name} {name};" for name in found.handles),
        "",
    ]
    for name, fields in found.records.items():
        lines += [
            "typedef struct {",
            *(f"    {SCALARS[kind]} {one};" for one, kind in fields.items()),
            f"}} {name};",
            "",
        ]
    lines += [f"{_prototype(one, found)};" for one in found.functions.values()]
    lines += ["", *(f"void {_destroyer(name)}({name} *);" for name in found.handles), "", "#endif", ""]
    return "\n".join(lines)


def _destroyer(handle: str) -> str:
    return f"mbkf_free_{handle.lower()}"


def _c_type(value: str, found: Declarations) -> str:
    return f"{value} *" if value in found.handles else "void " if value == "void" else f"{SCALARS[value]} "


def _prototype(one: Function, found: Declarations) -> str:
    parameters = [f"int {size}" for size in one.sizes]
    for value in (*one.arguments, *one.made):
        if value.is_array:
            const = "const " if value.role == "In" else ""
            parameters.append(f"{const}{ARRAYS[value.type][0]} *{value.name}")
        elif value.role == "Made":
            parameters.append(f"{SCALARS[value.type]} *{value.name}")
        elif value.type in found.records:
            parameters.append(f"const {value.type} *{value.name}")
        else:
            parameters.append(f"{_c_type(value.type, found)}{value.name}")
    return f"{_c_type(one.returned, found)}mbkf_{one.name}({', '.join(parameters) or 'void'})"


def binding(found: Declarations) -> str:
    """``binding.h``."""
    lines = [
        MADE,
        '#include "feet.h"',
        '#include "tree.h"',
        "",
        f'static const char fingerprint[] = "{found.fingerprint}";',
        "",
    ]
    for name, fields in found.records.items():
        lines += _record_reader(name, fields)
    for name in found.handles:
        lines += [
            f"static void forget_{name}(PyObject *capsule)",
            "{",
            "    PyObject *owner = PyCapsule_GetContext(capsule);",
            f'    {_destroyer(name)}(PyCapsule_GetPointer(capsule, "{name}"));',
            "    Py_XDECREF(owner);",
            "}",
            "",
        ]
    for one in found.functions.values():
        lines += [*_Wrapper(one, found).lines(), ""]
    lines.append("static PyMethodDef declared_functions[] = {")
    for name in found.functions:
        lines.append(f'    {{"{name}", (PyCFunction)(void (*)(void))py_{name}, METH_FASTCALL, NULL}},')
    lines += ["    {NULL, NULL, 0, NULL},", "};", ""]
    return "\n".join(lines)


def _record_reader(name: str, fields: dict[str, str]) -> Iterator[str]:
    reads = [
        f'field_read(place, object, "{one}", {kind}_read, &record->{one})' for one, kind in fields.items()
    ]
    yield f"static int {name}_argument(Place place, PyObject *object, {name} *record)"
    yield "{"
    yield "    return " + " &&\n           ".join(reads) + ";"
    yield "}"
    yield ""


class _Wrapper:
    """Writes the C function that Python calls."""

    def __init__(self, function: Function, found: Declarations) -> None:
        self._function, self._found = function, found
        self._sizes: dict[str, str] = {}  # the C expression of each size that is known so far
        self._given = {value.name: f"given[{i}]" for i, value in enumerate(function.arguments)}
        self._arrays = [value for value in function.made if value.is_array]

    def lines(self) -> Iterator[str]:
        """The function, line by line."""
        one = self._function
        yield f"static PyObject *py_{one.name}(PyObject *self, PyObject *const *given, Py_ssize_t count)"
        yield "{"
        yield "    (void)self, (void)given;"
        yield from _unless(f'has_arguments("{one.name}", count, {len(one.arguments)})')
        for value in one.arguments:
            yield from self._taken(value)
        for value in filter(lambda value: value.is_array, one.arguments):
            yield from self._shape_checked(value)
        for condition in one.requires:
            names = list(dict.fromkeys(NAME.findall(condition)))
            numbers = ", ".join(f"(long)({self._in_c(name)})" for name in names)
            text = f"{one.name}: {condition} is required; got {', '.join(f'{name} = %ld' for name in names)}"
            yield f"    if (!({self._in_c(condition)}))"
            yield f'        return PyErr_Format(PyExc_ValueError, "{text}", {numbers});'
        for value in one.arguments:
            if value.bounds is not None:
                bounds = ", ".join(self._in_c(bound) for bound in value.bounds)
                yield from _unless(f"are_within({self._place(value)}, {self._given[value.name]}, {bounds})")
        yield from self._called()
        yield "}"

    def _taken(self, value: Value) -> Iterator[str]:
        """Converts an argument, and notes the sizes that it sets."""
        place, given, name = self._place(value), self._given[value.name], value.name
        if value.is_array:
            starred = value.sizes[0].startswith("*")
            flags = [ORDERS[value.order]]
            flags += ["WRITABLE"] * (value.role == "Out") + ["ANY_DIMENSIONS"] * starred
            checked = f'{ARRAYS[value.type][1]}, {" | ".join(flags)}, {len(value.sizes) - starred}, "{_text(value)}"'
            yield from _unless(self._or_absent(value, f"is_array({place}, {given}, {checked})"))
            for axis, size in enumerate(value.sizes):
                plain = size.lstrip("*")
                if NAME.fullmatch(plain) and plain not in self._sizes:
                    self._sizes[plain] = f"n_{plain}"
                    yield f"    const npy_intp n_{plain} = {self._extent(value, axis)};"
        elif value.type in self._found.handles:
            yield f'    {value.type} *{name} = handle_argument({place}, {given}, "{value.type}");'
            yield from _unless(name)
            for size in self._found.handles[value.type]:
                self._sizes.setdefault(size, f"{name}->{size}")
        else:
            yield f"    {SCALARS.get(value.type, value.type)} {name};"
            yield from _unless(f"{value.type}_argument({place}, {given}, &{name})")
            if value.type == "int":
                self._sizes[name] = name

    def _shape_checked(self, value: Value) -> Iterator[str]:
        sizes = [self._in_c(size.lstrip("*")) for size in value.sizes]
        tests = [f"{self._extent(value, axis)} == {size}" for axis, size in enumerate(sizes)]
        wanted = f'"{_text(value)}", {len(sizes)}, (npy_intp[]){{{", ".join(sizes)}}}'
        yield f"    if (!({self._or_absent(value, ' && '.join(tests))}))"
        yield f"        return wrong_shape({self._place(value)}, {self._given[value.name]}, {wanted});"

    def _called(self) -> Iterator[str]:
        """Makes the results, calls the body, and gives back what it found."""
        one, arrays = self._function, self._arrays
        for value in one.made:
            if not value.is_array:
                yield f"    {SCALARS[value.type]} {value.name};"
        yield f"    PyObject *made[{len(arrays) + 1}];"
        if arrays:
            shapes = ", ".join(
                f"{{{ARRAYS[value.type][1]}, {int(value.order == 'fortran')}, {len(value.sizes)}, "
                f"{{{', '.join(map(self._in_c, value.sizes))}}}}}"
                for value in arrays
            )
            yield from _unless(f"made_arrays({len(arrays)}, (Shape[]){{{shapes}}}, made)")
        own = one.returned != "void"
        if own:
            yield f"    {_c_type(one.returned, self._found)}found;"
        if one.unlocked:
            yield "    Py_BEGIN_ALLOW_THREADS"
        yield f"    {'found = ' if own else ''}mbkf_{one.name}({', '.join(self._passed())});"
        if one.unlocked:
            yield "    Py_END_ALLOW_THREADS"
        yield f'    if (is_refused("{one.name}", {len(arrays)}, made))'
        yield "        return NULL;"
        results = [self._in_python(one.returned, "found")] if own else []
        for value in one.made:
            results.append(
                self._from_body(value) if value.is_array else self._in_python(value.type, value.name)
            )
        if len(results) > 1:
            yield f"    return packed({len(results)}, (PyObject *[]){{{', '.join(results)}}});"
        else:
            yield f"    return {results[0] if results else 'Py_NewRef(Py_None)'};"

    def _passed(self) -> Iterator[str]:
        """Arguments of the body."""
        one = self._function
        yield from (f"(int){self._sizes[size]}" for size in one.sizes)
        for value in one.arguments:
            given = self._given[value.name]
            if value.is_array:
                yield f"{given} == Py_None ? NULL : memory({given})" if value.optional else f"memory({given})"
            else:
                yield f"&{value.name}" if value.type in self._found.records else value.name
        for value in one.made:
            yield f"memory({self._from_body(value)})" if value.is_array else f"&{value.name}"

    def _from_body(self, value: Value) -> str:
        return f"made[{self._arrays.index(value)}]"

    def _in_python(self, kind: str, name: str) -> str:
        """A new Python object of a C value."""
        if kind in self._found.handles:
            owners = [
                self._given[one.name] for one in self._function.arguments if one.type in self._found.handles
            ]
            return f'new_handle({name}, "{kind}", forget_{kind}, {owners[0] if owners else "NULL"})'
        return {"float": "PyFloat_FromDouble", "int": "PyLong_FromLong", "bool": "PyBool_FromLong"}[
            kind
        ] + f"({name})"

    def _place(self, value: Value) -> str:
        return f'(Place){{"{self._function.name}", "{value.name}"}}'

    def _or_absent(self, value: Value, test: str) -> str:
        return f"({self._given[value.name]} == Py_None || ({test}))" if value.optional else test

    def _extent(self, value: Value, axis: int) -> str:
        """An array's number of elements along an axis, or along all that a star stands for."""
        given, count = self._given[value.name], len(value.sizes)
        if not value.sizes[0].startswith("*"):
            return f"extent({given}, {axis})"
        return (
            f"extent_from_end({given}, {count - axis})" if axis else f"leading_extent({given}, {count - 1})"
        )

    def _in_c(self, expression: str) -> str:
        """An expression of sizes, by the variables that hold them."""
        return NAME.sub(lambda match: self._sizes[match[0]], expression)


def _unless(test: str) -> tuple[str, str]:
    return f"    if (!{test})", "        return NULL;"


def _text(value: Value) -> str:
    return f"({', '.join(value.sizes)}{',' if len(value.sizes) == 1 else ''})"
