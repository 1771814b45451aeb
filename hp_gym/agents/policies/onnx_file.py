"""Policies as ONNX graphs, for runtimes outside Python."""

import os
from typing import Any, Final

import numpy as np

from hp_gym import extras
from hp_gym.agents.policies.checksum import CHECKSUM_KEY, checksum
from hp_gym.agents.policies.errors import PolicyError
from hp_gym.agents.policies.policy_file import METADATA_KEY, assemble, file_bytes, metadata_text, tensors_of
from hp_gym.agents.policies.saved_policy import MASKED_LOGIT, SavedPolicy

with extras.needed("export"):
    import onnx
    from google.protobuf.message import DecodeError
    from onnx import TensorProto, helper, numpy_helper

# Old enough for runtimes on devices.
_OPSET: Final = 17
_IR_VERSION: Final = 8


def to_model(policy: SavedPolicy) -> onnx.ModelProto:
    """Returns a policy as a graph.

    It takes `observations` (n, rows) as the environment gives them and, if the policy was trained with masks,
    `masks` (n, options). It returns `actions` (n, actions), the indices of options as int64 or values in
    [-1, 1], and `outputs`, the network's values from which they come.
    """
    metadata = policy.metadata
    tensors = tensors_of(policy)
    rows, width = len(metadata.environment.observations), len(policy.layers[-1][1])
    inputs = [helper.make_tensor_value_info("observations", TensorProto.FLOAT, ["n", rows])]
    if metadata.masked:
        inputs.append(helper.make_tensor_value_info("masks", TensorProto.BOOL, ["n", width]))
    kind = TensorProto.INT64 if metadata.option_counts else TensorProto.FLOAT
    actions = len(metadata.environment.actions)
    results = [
        helper.make_tensor_value_info("actions", kind, ["n", actions]),
        helper.make_tensor_value_info("outputs", TensorProto.FLOAT, ["n", width]),
    ]
    nodes = _normalise() if policy.normalisation is not None else []
    value = "normalised" if nodes else "observations"
    for index in range(len(policy.layers)):
        last = index == len(policy.layers) - 1
        names = [value, f"layers.{index}.weight", f"layers.{index}.bias"]
        value = "outputs" if last else f"sum.{index}"
        nodes.append(helper.make_node("Gemm", names, [value], transB=1))
        if not last:
            operation = {"tanh": "Tanh", "relu": "Relu"}[metadata.network.activation]
            nodes.append(helper.make_node(operation, [value], [f"hidden.{index}"]))
            value = f"hidden.{index}"
    nodes += _decide(policy)
    graph = helper.make_graph(
        nodes,
        "policy",
        inputs,
        results,
        [numpy_helper.from_array(tensor, name) for name, tensor in tensors.items()],
    )
    model = helper.make_model(
        graph, opset_imports=[helper.make_opsetid("", _OPSET)], ir_version=_IR_VERSION, producer_name="hp_gym"
    )
    text = metadata_text(policy)
    helper.set_model_props(model, {METADATA_KEY: text, CHECKSUM_KEY: checksum(text, tensors)})
    onnx.checker.check_model(model)
    return model


def read(path: str | os.PathLike[str]) -> SavedPolicy:
    """Reads the policy back out of a file that `hp-gym export` wrote.

    Raises:
        PolicyError: The file is truncated, foreign, changed, or does not fit this version of hp_gym.
        OSError: The file cannot be read.
    """
    name = os.fspath(path)
    try:
        # From bytes: a graph can then not name other files to be read.
        model = onnx.load_model_from_string(file_bytes(path))
    except DecodeError as error:
        message = f"{name}: no complete ONNX file"
        raise PolicyError(message) from error
    # Where it is no UTF-8, the library gives bytes, whatever it declares.
    texts = [str(entry.value) for entry in model.metadata_props if entry.key == METADATA_KEY]
    sums = [str(entry.value) for entry in model.metadata_props if entry.key == CHECKSUM_KEY]
    if len(texts) != 1:
        message = f"{name}: no ONNX file of a policy of hp_gym (no `{METADATA_KEY}` in its metadata)"
        raise PolicyError(message)
    if any(entry.data_location == TensorProto.EXTERNAL for entry in model.graph.initializer):
        message = f"{name}: its numbers are in another file, but must be in the file itself"
        raise PolicyError(message)
    try:
        tensors: dict[str, Any] = {
            str(entry.name): numpy_helper.to_array(entry) for entry in model.graph.initializer
        }
    # What the library raises on a tensor that does not fit itself differs from case to case.
    except Exception as error:
        message = f"{name}: a tensor cannot be read ({type(error).__name__}: {error})"
        raise PolicyError(message) from error
    policy = assemble(name, texts[0], tensors, sums[0] if sums else None)
    if to_model(policy).graph != model.graph:
        message = f"{name}: the graph is not the one that its metadata describe"
        raise PolicyError(message)
    return policy


def _normalise() -> list[onnx.NodeProto]:
    """In double precision, as VecNormalize does."""
    return [
        helper.make_node("Cast", ["observations"], ["double"], to=TensorProto.DOUBLE),
        helper.make_node("Sub", ["double", "observation.mean"], ["centred"]),
        helper.make_node("Add", ["observation.variance", "observation.epsilon"], ["square"]),
        helper.make_node("Sqrt", ["square"], ["deviation"]),
        helper.make_node("Div", ["centred", "deviation"], ["scaled"]),
        helper.make_node("Neg", ["observation.clip"], ["lowest"]),
        helper.make_node("Max", ["scaled", "lowest"], ["from_below"]),
        helper.make_node("Min", ["from_below", "observation.clip"], ["held"]),
        helper.make_node("Cast", ["held"], ["normalised"], to=TensorProto.FLOAT),
    ]


def _decide(policy: SavedPolicy) -> list[onnx.NodeProto]:
    metadata = policy.metadata
    if metadata.output == "tanh":
        return [helper.make_node("Tanh", ["outputs"], ["actions"])]
    if metadata.output == "clip":
        return [
            _constant("low", np.array(-1.0, np.float32)),
            _constant("high", np.array(1.0, np.float32)),
            helper.make_node("Clip", ["outputs", "low", "high"], ["actions"]),
        ]
    nodes, value = [], "outputs"
    if metadata.masked:
        nodes.append(_constant("masked_logit", np.array(MASKED_LOGIT)))
        nodes.append(helper.make_node("Where", ["masks", "outputs", "masked_logit"], ["granted"]))
        value = "granted"
    counts = metadata.option_counts
    branches = [f"branch.{index}" for index in range(len(counts))]
    chosen = [f"option.{index}" for index in range(len(counts))]
    nodes.append(_constant("counts", np.array(counts, np.int64)))
    nodes.append(helper.make_node("Split", [value, "counts"], branches, axis=1))
    for branch, option in zip(branches, chosen, strict=True):
        nodes.append(helper.make_node("ArgMax", [branch], [option], axis=1, keepdims=1))
    nodes.append(helper.make_node("Concat", chosen, ["actions"], axis=1))
    return nodes


def _constant(name: str, value: np.ndarray[Any, Any]) -> onnx.NodeProto:
    return helper.make_node("Constant", [], [name], value=numpy_helper.from_array(value, name))
