"""The editor: what a person does to a model, in scenes, by actions and gestures, and what the view says of it."""
