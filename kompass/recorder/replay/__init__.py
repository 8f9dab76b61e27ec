"""From a recording back to the inputs of the engine; back-tests on recordings on disk."""
