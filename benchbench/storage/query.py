"""SQL over the table of runs."""

from __future__ import annotations

import pyarrow as pa

from benchbench.ground.errors import BadInput, Unavailable

NAME = "runs"
"""What the table is called in a query."""


def query(rows: pa.Table, sql: str) -> pa.Table:
    """Return what a DuckDB SELECT over the table `runs` gives.

    Raises BadInput for SQL that DuckDB refuses or that gives no table, Unavailable where DuckDB is
    not installed.
    """
    try:
        import duckdb
    except ImportError:
        raise Unavailable("--query: duckdb is not installed; pip install 'benchbench[report]'") from None
    with duckdb.connect() as connection:
        connection.register(NAME, rows)
        try:
            found = connection.sql(sql)
            if found is None:
                raise BadInput("--query", "gives no table", f"a SELECT from the table '{NAME}'")
            if len(set(found.columns)) < len(found.columns):
                raise BadInput(
                    "--query", f"gives columns of one name: {', '.join(found.columns)}", "names by AS"
                )
            return found.to_arrow_table()
        except duckdb.Error as error:
            problem = str(error).strip().replace("\n", " ")
            raise BadInput("--query", problem, f"a SELECT in DuckDB's SQL from the table '{NAME}'") from None
