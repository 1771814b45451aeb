"""The Gymnasium environments, what wraps them, and the paper's rules as a policy for them."""
