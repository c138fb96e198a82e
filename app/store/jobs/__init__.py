"""The queue: jobs, leases, outcomes and imports."""
