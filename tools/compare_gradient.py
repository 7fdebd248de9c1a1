#!/usr/bin/env python3
"""Times the gradient of the paper's network in PyTorch eager, to set beside ours.

The network is (1), (5) of the paper with three IIR and six FIR neurons of first order, one input
and one output, over 1000 samples from rest; the cost is the sum of squared free-run errors. Its
gradient here is reverse mode over a loop of tensors of each layer, as one writes it in PyTorch;
ours is `jacobian` in

    cargo bench -p drivescope-diagnoser -- "paper network"

which yields the derivative of every sample, more than the gradient. Needs PyTorch (`torch`), which
no test needs.
"""

import argparse
import statistics
import time

import torch

SAMPLES = 1000
V1, V2 = 3, 6


def parameters(generator: torch.Generator) -> dict[str, torch.Tensor]:
    """Random parameters in the shape of the paper's network."""
    shapes = {
        "w": (V1,),
        "theta": (V1,),
        "b": (V1,),
        "b_0": (V1,),
        "g_1": (V1,),
        "g_2": (V1,),
        "w_2": (V2, V1),
        "w_u": (V2,),
        "c": (V2,),
    }

    def draw(shape: tuple[int, ...]) -> torch.Tensor:
        return (0.5 * torch.randn(shape, generator=generator, dtype=torch.float64)).requires_grad_()

    return {name: draw(shape) for name, shape in shapes.items()}


def free_run(p: dict[str, torch.Tensor], u: torch.Tensor) -> torch.Tensor:
    """y(k) = C x2(k), x2(k+1) = W2 tanh(G2 (B1 x1 + D1 u - g1)) + Wu u, x1(k+1) = A1 x1 + W1 u."""
    a = torch.tanh(p["theta"])
    x1 = torch.zeros(V1, dtype=torch.float64)
    x2 = torch.zeros(V2, dtype=torch.float64)
    y = []
    for u_k in u:
        y.append(p["c"] @ x2)
        sigma = torch.tanh(p["g_2"] * (p["b"] * x1 + p["b_0"] * p["w"] * u_k - p["g_1"]))
        x2 = p["w_2"] @ sigma + p["w_u"] * u_k
        x1 = -a * x1 + p["w"] * u_k
    return torch.stack(y)


def main() -> None:
    """Prints the median time of a gradient."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=10, help="gradients to time")
    parser.add_argument("--threads", type=int, default=1, help="threads of PyTorch")
    arguments = parser.parse_args()
    torch.set_num_threads(arguments.threads)
    generator = torch.Generator().manual_seed(1)
    p = parameters(generator)
    u = torch.randn(SAMPLES, generator=generator, dtype=torch.float64)
    measured = torch.randn(SAMPLES, generator=generator, dtype=torch.float64)
    times = []
    for _ in range(arguments.repeats):
        start = time.perf_counter()
        error = ((free_run(p, u) - measured) ** 2).sum()
        torch.autograd.grad(error, list(p.values()))
        times.append(time.perf_counter() - start)
    print(
        f"PyTorch {torch.__version__} eager, {SAMPLES} samples, {arguments.threads} thread(s): "
        f"gradient {1e3 * statistics.median(times):.1f} ms "
        f"({1e3 * min(times):.1f} to {1e3 * max(times):.1f} ms over {arguments.repeats})"
    )


if __name__ == "__main__":
    main()
