"""Property tests have no time limit for one example: compilation and busy machines are not failures."""
from hypothesis import settings

settings.register_profile("asemd", deadline=None)
settings.load_profile("asemd")
