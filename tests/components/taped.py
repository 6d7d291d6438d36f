"""A component's inputs and outputs in a run, and what it remembered: it is pure, so it may run alone."""

import ast
from collections import deque
from enum import Enum

import numpy as np

from surefoot.bus.codec import encode
from surefoot.bus.message import Message
from surefoot.components.clock_messages import pack_snapshot, unpack_snapshot
from surefoot.components.component import Component, Inbox, Outbox
from surefoot.components.registry import component_class


class Taped(Component):
    """Stands in for a component in a run.

    Attributes:
        part: the component.
        tape: of every step its time, what was new in the inbox, and the bytes that were published.
        memories: packed snapshots by the number of steps before them, each taken when `remember` was set.
        beside: what it held then beside its memory, as `carried` tells it.
    """

    def __init__(self, part, scratch):
        super().__init__(part.deployment)
        self.part, self.name, self.inputs, self.outputs = part, part.name, part.inputs, part.outputs
        self.tape, self.memories, self.beside, self.remember = [], {}, [], False
        self._scratch = scratch
        self._waiting, self._said = [], []
        self._own = Outbox(part.outputs, lambda key, message: self._said.append((key, message)))

    def warm_up(self):
        self.part.warm_up()

    def activate(self, t, inbox):
        active = self.part.activate(t, inbox)
        if not active:
            self._waiting.append(_new(inbox))
        return active

    def step(self, t, inbox, outbox):
        if self.remember:
            self.memories[len(self.tape)] = pack_snapshot(self.part.snapshot())
            self.beside.append(carried(self.part, self._scratch))
            self.remember = False
        self.part.step(t, inbox, self._own)
        before = [item for new in self._waiting for item in new]
        self.tape.append((t, before, _new(inbox), [(key, encode(m, volatile=False)) for key, m in self._said]))
        for key, message in self._said:
            outbox.publish(key, message)
        self._said.clear()
        self._waiting.clear()

    def snapshot(self):
        return self.part.snapshot()

    def heir(self, steps):
        """Another component with the memory of after so many steps."""
        other = component_class(self.name)(self.deployment)
        other.warm_up()
        other.restore(unpack_snapshot(self.memories[steps]))
        return other

    def differs(self, other, steps, seconds):
        """When `other` first says something else, in the seconds after so many steps; None: it does not."""
        said = []
        inbox, end = Inbox(self.inputs), self.tape[steps][0] + seconds
        outbox = Outbox(self.outputs, lambda key, message: said.append((key, message)))
        outbox.continue_from(_counts(self.tape[:steps]))
        for number, (t, before, new, expected) in enumerate(self.tape):
            if t > end:
                return None
            _deliver(inbox, before)
            if number >= steps:
                inbox.clear_new()
            _deliver(inbox, new)
            if number >= steps:
                other.step(t, inbox, outbox)
                if [(key, encode(message, volatile=False)) for key, message in said] != expected:
                    return t
                said.clear()
            inbox.clear_new()
        return None


def _new(inbox):
    return [(key, message) for key in inbox._new for message in inbox.new(key)]


def _deliver(inbox, messages):
    for key, message in messages:
        inbox.deliver(key, message)


def _counts(tape):
    counts = {}
    for *_, said in tape:
        for key, _ in said:
            counts[key] = counts.get(key, 0) + 1
    return counts


def carried(thing, scratch, path=""):
    """All that an object of the project holds beside its memory and its scratch, down to values, by path."""
    found = {}
    kinds = [kind.__name__ for kind in type(thing).__mro__]
    dropped = set().union(*(scratch.get(kind, ()) for kind in kinds))
    remembered = thing.memory.names if hasattr(thing, "memory") else ()
    for name, value in vars(thing).items() if "*" not in dropped else ():
        where = f"{path}.{type(thing).__name__}.{name}"
        part = type(value).__module__.startswith("surefoot.components.") and not isinstance(value, Enum)
        if name in dropped or (name in remembered and not hasattr(value, "memory")):
            continue
        found |= carried(value, scratch, where) if part else {where: _frozen(value)}
    return found


def _frozen(value):
    if isinstance(value, Message):
        return encode(value)
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, (list, tuple, deque)):
        return [_frozen(each) for each in value]
    if isinstance(value, dict):
        return {key: _frozen(each) for key, each in value.items()}
    if isinstance(value, (set, frozenset)):
        return sorted(value)
    return value if isinstance(value, (int, float, str, bytes, type(None))) else type(value)


_MUTATORS = {"append", "extend", "add", "remove", "discard", "clear", "pop", "update", "insert", "fill"}


def written(source):
    """Names of the attributes that methods in a module's source write to, other than on creation or tuning."""
    names = set()
    for function in ast.walk(ast.parse(source)):
        if not isinstance(function, ast.FunctionDef) or function.name in ("__init__", "set_up"):
            continue
        for node in ast.walk(function):
            if isinstance(node, ast.Assign):
                names |= {name for target in node.targets for name in _attributes(target)}
            elif isinstance(node, (ast.AugAssign, ast.AnnAssign)):
                names |= _attributes(node.target)
            elif (
                isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in _MUTATORS
            ):
                names |= _attributes(node.func.value)
    return names


def _attributes(target):
    if isinstance(target, (ast.Tuple, ast.List)):
        return {name for each in target.elts for name in _attributes(each)}
    while isinstance(target, (ast.Subscript, ast.Starred)):
        target = target.value
    return {target.attr} if isinstance(target, ast.Attribute) else set()


def memory_names(thing):
    """Names of all that an object and its parts remember."""
    parts = [value for value in vars(thing).values() if hasattr(type(value), "memory")]
    return {*thing.memory.names, *(name for part in parts for name in memory_names(part))}
