"""Public conformance suites, one per plugin family, over every plugin that is installed.

    pytest --pyargs benchbench.conformance            # all suites
    pytest --pyargs benchbench.conformance -k NAME    # those of one plugin

A plugin is tested because it is registered as an entry point: with every YAML on the configuration search
path that names its class, or, where there is none, built without arguments. One that cannot be built fails;
only a solver whose library is missing is skipped. The checks are plain functions of a plugin in
`benchbench.conformance.checks`, to be called from a plugin's own tests; they raise AssertionError.
"""
