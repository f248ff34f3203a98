"""Normal contact: displacement, compliance, active set, forces."""
