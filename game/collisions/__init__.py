"""Collisions in a run: free particles fly from impact to impact, others meet within the steps of an integrator."""
