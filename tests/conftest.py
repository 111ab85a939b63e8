from hypothesis import settings

settings.register_profile("v3dcad", deadline=None, derandomize=True, max_examples=150)
settings.load_profile("v3dcad")
