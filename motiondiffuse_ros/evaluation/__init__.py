"""How good is a model: text-motion evaluator, the paper's metrics and protocol, baselines."""
