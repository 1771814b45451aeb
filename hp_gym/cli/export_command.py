"""`hp-gym export`: a policy for runtimes outside Python."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hp_gym.cli.output import console, fail, print_json
from hp_gym.terminal import progress_console

if TYPE_CHECKING:
    from hp_gym.agents.policies.equality import Decide
    from hp_gym.agents.policies.saved_policy import SavedPolicy


def export(
    policy: Annotated[Path, typer.Argument(help="Policy file (.safetensors, .onnx; .zip if allowed).")],
    *,
    out: Annotated[Path, typer.Option(help="File to write: .onnx or .safetensors.")],
    allow_code: Annotated[
        bool,
        typer.Option("--allow-code", help="Load a zip file of stable-baselines3, which can run code."),
    ] = False,
    normalisation: Annotated[
        Path | None, typer.Option(help="Pickled VecNormalize that belongs to a zip file.")
    ] = None,
    continuous: Annotated[
        bool, typer.Option("--continuous", help="For a zip file: actions are values.")
    ] = False,
    actions: Annotated[list[str] | None, typer.Option(help="For a zip file: actuators or a set.")] = None,
    observations: Annotated[list[str] | None, typer.Option(help="For a zip file: rows or groups.")] = None,
    control_interval_s: Annotated[int, typer.Option(min=1, help="For a zip file.")] = 1,
    json: Annotated[bool, typer.Option("--json", help="Print the comparison as JSON.")] = False,
) -> None:
    """Writes a policy as ONNX, once it is proved equal on observations of driven trips."""
    from dataclasses import asdict

    from hp_gym import extras

    extras.require("export")
    from hp_gym.agents.policies import save
    from hp_gym.agents.policies.equality import compare
    from hp_gym.agents.policies.onnx_file import to_model
    from hp_gym.files import atomic_write, require_suffix

    try:
        suffix = require_suffix(out, [".onnx", ".safetensors"])
        environment: dict[str, Any] = {
            "continuous": continuous,
            "actions": _one_or_more(actions),
            "observations": _one_or_more(observations),
            "control_interval_s": control_interval_s,
        }
        loaded, original = _load(policy, environment, normalisation, allow_code=allow_code)
        model = to_model(loaded)
        equality = compare(model, loaded, original)
        if suffix == ".safetensors":
            save(out, loaded)
        else:
            with atomic_write(out) as temporary:
                temporary.write_bytes(model.SerializeToString())
    except (ValueError, OSError) as error:
        fail(error)
    if json:
        print_json({"policy": str(policy), "out": str(out)} | asdict(equality))
        return
    console.print(
        f"Equal on {equality.observations} observations of {equality.trips} trips: largest difference of the "
        f"network's outputs {equality.largest_output_difference:.2g}, actions that differ (ties) "
        f"{equality.differing_actions}.\nWritten: {out}",
        soft_wrap=True,
    )


def _one_or_more(names: list[str] | None) -> str | list[str]:
    if not names:
        return "default"
    return names[0] if len(names) == 1 and names[0] in {"default", "heat", "hpcu", "all"} else names


def _load(
    path: Path, environment: dict[str, Any], normalisation: Path | None, *, allow_code: bool
) -> "tuple[SavedPolicy, Decide | None]":
    from hp_gym.agents.policies import load

    if path.suffix.lower() != ".zip" or not allow_code:
        return load(path), None
    from hp_gym.agents.policies.saved_policy import PolicyEnvironment
    from hp_gym.agents.policies.sb3_zip import WARNING, load_sb3_zip

    progress_console.print(f"Warning: {WARNING}.", soft_wrap=True)
    policy, model = load_sb3_zip(
        path, PolicyEnvironment.resolve(**environment), allow_code=True, normalisation=normalisation
    )

    def decide(observations: Any, masks: Any) -> Any:
        if policy.normalisation is not None:
            observations = policy.normalisation.apply(observations)
        more = {} if masks is None else {"action_masks": masks}
        return model.predict(observations, deterministic=True, **more)[0]

    return policy, decide
