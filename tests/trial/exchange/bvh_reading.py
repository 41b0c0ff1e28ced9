"""A reader of BVH made from the format's definition alone: places of all joints in all frames."""

from dataclasses import dataclass

import numpy as np


@dataclass
class Node:
    name: str
    offset: np.ndarray
    channels: list
    parent: int


def turn(axis, degrees):
    c, s = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    return {
        "X": np.array([[1, 0, 0], [0, c, -s], [0, s, c]]),
        "Y": np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]),
        "Z": np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]),
    }[axis]


def read(text):
    """Nodes (end sites, too), rows of numbers, and the frame time; each word is checked."""
    head, _, tail = text.partition("MOTION")
    words = iter(head.split())
    assert next(words) == "HIERARCHY"
    nodes, stack, name = [], [], None
    for word in words:
        if word in ("ROOT", "JOINT"):
            assert (word == "ROOT") == (not nodes)
            name = next(words)
        elif word == "End":
            assert next(words) == "Site"
            name = f"{nodes[stack[-1]].name}/end"
        elif word == "{":
            assert next(words) == "OFFSET"
            offset = np.array([float(next(words)) for _ in range(3)])
            nodes.append(Node(name, offset, [], stack[-1] if stack else -1))
            stack.append(len(nodes) - 1)
        elif word == "CHANNELS":
            nodes[stack[-1]].channels = [next(words) for _ in range(int(next(words)))]
        else:
            assert word == "}", word
            stack.pop()
    assert not stack
    lines = [line for line in tail.splitlines() if line.strip()]
    frames, time = lines[0].split(":"), lines[1].split(":")
    assert (frames[0], time[0]) == ("Frames", "Frame Time")
    rows = np.array([[float(word) for word in line.split()] for line in lines[2:]])
    assert rows.shape == (int(frames[1]), sum(len(node.channels) for node in nodes))
    return nodes, rows, float(time[1])


def places(nodes, row):
    """World place and rotation of every node, by name."""
    numbers, found = iter(row), []
    for node in nodes:
        R0, p0 = found[node.parent] if node.parent >= 0 else (np.eye(3), np.zeros(3))
        shift, R = node.offset.copy(), np.eye(3)
        for channel in node.channels:
            number = next(numbers)
            if channel.endswith("position"):
                shift["XYZ".index(channel[0])] += number
            else:
                assert channel.endswith("rotation")
                R = R @ turn(channel[0], number)
        found.append((R0 @ R, p0 + R0 @ shift))
    return {node.name: place for node, place in zip(nodes, found, strict=True)}
