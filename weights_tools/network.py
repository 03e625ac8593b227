"""A network that can be trained: a description with parameters."""

import math
from collections.abc import Callable, Collection, Mapping

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor, nn

from weights_tools.builder import Description, Layer
from weights_tools.graph import run

# Sharpness of the softplus that keeps the weights of normalized convolutions positive in training.
SOFTPLUS_BETA = 10.0
# Size of filters whose training continues, in that of new ones: steps of a fixed size make filters
# grow. Other values were not tried.
KEPT_SIZE = 2.0


class Network(nn.Module):
    """Parameters are named layers.LAYER.weight and layers.LAYER.bias.

    With `normalizes`, batches are normalized behind 3 x 3 convolutions, whose names begin with `only`,
    while it is trained (Ioffe and Szegedy, "Batch Normalization"); otherwise, and in files, that is
    part of the weights.
    """

    def __init__(
        self, description: Description, seed: int = 0, normalizes: bool = False, only: str = ""
    ) -> None:
        super().__init__()
        self.description = description
        self.normalizations = nn.ModuleDict(
            {
                layer.name: nn.BatchNorm2d(layer.outputs, momentum=0.05)
                for layer in description.layers
                if normalizes and _is_inner_convolution(layer) and layer.name.startswith(only)
            }
        )
        self.layers = nn.ModuleDict(
            {layer.name: nn.ParameterDict() for layer in description.layers}
        )
        self.load(initial_weights(description, seed))

    def load(self, weights: Mapping[str, np.ndarray]) -> None:
        """Loads weights in the form that files have."""
        for layer in self.description.layers:
            weight = torch.as_tensor(weights[f"{layer.name}.weight"])
            bias = torch.as_tensor(weights[f"{layer.name}.bias"])
            if tuple(weight.shape) != layer.shape or tuple(bias.shape) != (layer.outputs,):
                raise ValueError(
                    f'layer "{layer.name}" of "{self.description.graph.name}" has the shape '
                    f"{layer.shape}, but the weights have {tuple(weight.shape)}"
                )
            if layer.is_normalized:
                weight = _inverse_softplus(weight.double()).to(weight.dtype)
            self.layers[layer.name]["weight"] = nn.Parameter(weight.clone())
            self.layers[layer.name]["bias"] = nn.Parameter(bias.clone())

    @torch.no_grad()
    def calibrate(
        self, inputs: Mapping[str, Tensor], layers: Collection[str], bfloat16: bool = False
    ) -> None:
        """Initializes the batch normalization behind these layers so that it changes nothing for
        these inputs, and their training continues from loaded weights.

        Loaded filters have taken in the normalization of their own training, and some are a
        twentieth of what they were. Steps of a given size would turn those so much farther, so each
        filter gets `KEPT_SIZE` times the size of a new one, which normalization takes out again.
        """
        of_layer = {layer.name: layer for layer in self.description.layers}
        factors: dict[str, Tensor] = {}
        for name in layers:
            weight = self.layers[name]["weight"]
            size = weight.square().mean(dim=(1, 2, 3)).sqrt()
            wanted = KEPT_SIZE * initial_bound(of_layer[name]) / math.sqrt(3)
            factors[name] = wanted / size.clamp(min=0.01 * wanted)  # what is nearly zero stays so

        def observe(norm: nn.BatchNorm2d, factor: Tensor) -> Callable[[Tensor], Tensor]:
            def identity(x: Tensor) -> Tensor:
                variance, mean = torch.var_mean(x.float(), dim=(0, 2, 3), unbiased=False)
                scaled = variance * factor.square()
                for kept, seen in ((norm.running_mean, mean * factor), (norm.running_var, scaled)):
                    kept.copy_(seen)
                norm.weight.copy_((scaled + norm.eps).sqrt() / factor)
                norm.bias.copy_(mean)
                return x

            return identity

        behind = {
            name: observe(norm, factors[name]) if name in layers else norm
            for name, norm in self.normalizations.items()
        }
        run(self.description.graph, self._plain_weights(), inputs, bfloat16, behind)
        for name, factor in factors.items():
            self.layers[name]["weight"].mul_(factor[:, None, None, None])
            self.layers[name]["bias"].mul_(factor)

    @property
    def knows_any_unit(self) -> bool:
        """Whether the input may have any unit; otherwise it must be metres."""
        return any(port["name"] == "log_depth" for port in self.description.graph.outputs)

    def inner_convolutions(self) -> list[nn.Parameter]:
        """Weights of the 3 x 3 convolutions between inputs and outputs."""
        layers = filter(_is_inner_convolution, self.description.layers)
        return [self.layers[layer.name]["weight"] for layer in layers]

    def fix_others(self, prefix: str) -> None:
        """Excludes from training all layers whose names do not begin so."""
        for layer in self.description.layers:
            if not layer.name.startswith(prefix):
                self.layers[layer.name].requires_grad_(False)

    def fix_propagation(self) -> None:
        """Excludes the normalized convolutions of the first estimate from training. Those of a
        refinement, whose layers begin with "refined", come later and go on."""
        for layer in self.description.layers:
            if layer.is_normalized and not layer.name.startswith("refined"):
                self.layers[layer.name].requires_grad_(False)

    def weights(self) -> dict[str, Tensor]:
        """Weights in the form that operations and files have."""
        result = self._plain_weights()
        if self.training:
            return result
        for name, norm in self.normalizations.items():
            factor = norm.weight * (norm.running_var + norm.eps).rsqrt()
            weight, bias = (f"{name}.{role}" for role in ("weight", "bias"))
            result[weight] = result[weight] * factor[:, None, None, None]
            result[bias] = (result[bias] - norm.running_mean) * factor + norm.bias
        return result

    def _plain_weights(self) -> dict[str, Tensor]:
        """The same network without batch normalization."""
        result = {}
        for layer in self.description.layers:
            weight, bias = (self.layers[layer.name][role] for role in ("weight", "bias"))
            if layer.is_normalized:
                weight = F.softplus(weight, beta=SOFTPLUS_BETA)
            result[f"{layer.name}.weight"] = weight
            result[f"{layer.name}.bias"] = bias
        return result

    def tensors(self, inputs: Mapping[str, Tensor], bfloat16: bool = False) -> dict[str, Tensor]:
        """The result of every node, by name."""
        behind = self.normalizations if self.training else {}
        return run(self.description.graph, self.weights(), inputs, bfloat16, behind)

    def forward(self, inputs: Mapping[str, Tensor]) -> dict[str, Tensor]:
        tensors = self.tensors(inputs)
        return {port["name"]: tensors[port["tensor"]] for port in self.description.graph.outputs}


def _is_inner_convolution(layer: Layer) -> bool:
    return layer.shape[2:] == (3, 3) and layer.outputs > 1 and not layer.is_normalized


def initial_weights(description: Description, seed: int) -> dict[str, np.ndarray]:
    """Initial weights in the form that files have, the same on every machine."""
    generator = np.random.RandomState(seed)  # the same numbers in every version of NumPy
    return {
        f"{layer.name}.{role}": values
        for layer in description.layers
        for role, values in _initial(layer, generator).items()
    }


def initial_bound(layer: Layer) -> float:
    """The largest of a layer's initial weights, which are spread evenly and keep the variance from
    layer to layer (He et al., "Delving Deep into Rectifiers")."""
    return layer.gain * math.sqrt(6 / ((1 + layer.slope**2) * (layer.weights / layer.outputs)))


def _initial(layer: Layer, generator: np.random.RandomState) -> dict[str, np.ndarray]:
    """Uniform numbers only: they are made of whole ones and equal on every processor."""
    if layer.is_normalized:
        # A mean that prefers near points, a little different in each channel.
        size = layer.shape[-1]
        offset = np.arange(size) - size // 2
        sigma = max(size / 4, 0.5)  # pixels; corners have small but positive weights
        bump = np.exp(-(offset[:, None] ** 2 + offset**2) / (2 * sigma**2))
        weight = bump * generator.uniform(0.5, 1.5, layer.shape)
        bias = generator.uniform(-0.01, 0.01, layer.outputs)
    else:
        fan_in = layer.weights / layer.outputs
        bound = initial_bound(layer)
        weight = generator.uniform(-bound, bound, layer.shape)
        bias = generator.uniform(-1, 1, layer.outputs) * layer.gain / math.sqrt(fan_in)
        if layer.prior:
            bias = bias + layer.prior
    return {"weight": weight.astype(np.float32), "bias": bias.astype(np.float32)}


def _inverse_softplus(weight: Tensor) -> Tensor:
    # ln(e^{beta w} - 1) = beta w + ln(1 - e^{-beta w}), which does not overflow.
    tiny = torch.finfo(torch.float32).tiny  # what a weight of zero becomes
    scaled = SOFTPLUS_BETA * weight.clamp(min=tiny)
    return (scaled + torch.log(-torch.expm1(-scaled))) / SOFTPLUS_BETA
