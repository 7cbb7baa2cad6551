"""Dropout that costs little on a CPU."""

import torch as th
from torch import nn


class ByteDropout(nn.Dropout):
    """
    Dropout that draws a random byte for each unit on a CPU, where torch draws a number: several times faster.

    So the share of units that are left out is rounded to a multiple of 1/256.
    """

    def forward(self, input: th.Tensor) -> th.Tensor:
        """
        Leave out some units and scale up the others, while training.

        :param input: Units
        :return: Units of the same shape
        """
        left_out = round(256 * self.p)
        if not self.training or left_out == 0:
            return input
        if input.device.type != "cpu":
            return super().forward(input)
        words = th.empty(-(-input.numel() // 8), dtype=th.int64).random_(-(2**63), None)
        kept = words.view(th.uint8)[: input.numel()].view_as(input) >= left_out
        return input * kept.to(input.dtype).mul_(256 / (256 - left_out))
