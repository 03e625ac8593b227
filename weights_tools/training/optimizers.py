"""Steps of training: orthogonal ones for inner 3 x 3 convolutions (Muon), AdamW's for the rest."""

import math
from collections.abc import Iterable

import torch
from torch import Tensor

from weights_tools.network import Network

# Fraction of the running mean of gradients that a step keeps.
_MOMENTUM = 0.95
# Mean size of a number's step per unit of the rate: AdamW's are hardly larger than 1 and mostly
# smaller, and what both train then takes the same rates.
_STEP = 0.8
# x -> a x + b x^3 + c x^5 takes what is in 0..1 near 1 in few repetitions; within 0.7 to 1.2 will
# do (Jordan et al., "Muon: An optimizer for hidden layers in neural networks").
_A, _B, _C, _REPETITIONS = 3.4445, -4.7750, 2.0315, 5


class Muon(torch.optim.Optimizer):
    """Follows the nearest orthogonal matrix to the momentum of each weight, outputs x the rest.

    All directions of a layer learn equally fast, not mostly the few that its gradient is full of.
    """

    def __init__(
        self, parameters: Iterable[Tensor], lr: float, weight_decay: float, bfloat16: bool = False
    ) -> None:
        super().__init__(parameters, {"lr": lr, "weight_decay": weight_decay})
        self._type = torch.bfloat16 if bfloat16 else torch.float32

    @torch.no_grad()
    def step(self) -> None:
        for group in self.param_groups:
            for parameter in group["params"]:
                if parameter.grad is None:
                    continue
                state = self.state[parameter]
                if not state:
                    state["momentum"] = torch.zeros_like(parameter)
                momentum = state["momentum"].mul_(_MOMENTUM).add_(parameter.grad)
                ahead = (parameter.grad + _MOMENTUM * momentum).flatten(1)  # Nesterov momentum
                step = orthogonal(ahead.to(self._type)).to(parameter.dtype)
                # An orthogonal matrix of m x n numbers has a mean square of 1 / max(m, n).
                size = _STEP * group["lr"] * math.sqrt(max(step.shape))
                parameter.mul_(1 - group["lr"] * group["weight_decay"])
                parameter.add_(step.view_as(parameter), alpha=-size)


def orthogonal(matrix: Tensor) -> Tensor:
    """About U V' of a matrix U S V': what is small in it against the rest stays smaller."""
    x = matrix / (matrix.norm() + 1e-7)
    is_tall = x.shape[0] > x.shape[1]
    x = x.T if is_tall else x
    for _ in range(_REPETITIONS):
        square = x @ x.T
        x = torch.addmm(x, torch.addmm(square, square, square, beta=_B, alpha=_C), x, beta=_A)
    return x.T if is_tall else x


def make_optimizers(
    network: Network, rate: float, decay: float, bfloat16: bool
) -> list[torch.optim.Optimizer]:
    """Optimizers of the parameters that are to be trained; all have the same rate."""
    trained = [values for values in network.parameters() if values.requires_grad]
    inner = {id(values) for values in network.inner_convolutions()}
    matrices = [values for values in trained if id(values) in inner]
    others = [values for values in trained if id(values) not in inner]
    result: list[torch.optim.Optimizer] = []
    if matrices:
        result.append(Muon(matrices, rate, decay, bfloat16))
    if others:
        result.append(torch.optim.AdamW(others, rate, weight_decay=decay))
    return result
