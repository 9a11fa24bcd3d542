"""Editors check scenes by schemas/scene.schema.json: a validator that knows nothing of mortise must agree with the program.

validate_scenes.py SCHEMA SCENE_FOLDER BAD_FOLDER: every scene passes; of the bad scenes, those listed below fail.
"""
import json
import pathlib
import re
import sys

import jsonschema
import yaml


class Loader(yaml.SafeLoader):
    """PyYAML reads 1e-4 as text and 'yes' as true (YAML 1.1); editors follow YAML 1.2."""


Loader.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in known if tag not in ("tag:yaml.org,2002:bool", "tag:yaml.org,2002:float")]
    for first, known in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
Loader.add_implicit_resolver("tag:yaml.org,2002:bool", re.compile(r"^(true|false)$"), list("tf"))
Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float", re.compile(r"^[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?$"), list("-+0123456789.")
)
# Integers before floats, so that 3 stays a whole number.
for first, known in Loader.yaml_implicit_resolvers.items():
    known.sort(key=lambda entry: entry[0] != "tag:yaml.org,2002:int")

# What a schema can see: no names across blocks, no modes, no order of times.
VISIBLE = """unknown_key_typo unknown_root_key unknown_effect missing_required_keys missing_version other_version wrong_unit unknown_unit
unit_on_pure_number out_of_range quoted_number fraction_for_integer yes_for_flag text_for_number list_for_number number_for_block
two_entries_for_vector wrong_choice wrong_body_type key_of_other_body_type no_body_type no_shape two_shapes bad_where a_list""".split()


def main(schema_file, scenes, bad):
    schema = json.loads(pathlib.Path(schema_file).read_text())
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)

    def errors(path):
        return list(validator.iter_errors(yaml.load(path.read_text(), Loader=Loader)))

    failed = 0
    files = sorted(pathlib.Path(scenes).rglob("*.yaml"))
    for path in files:
        for e in errors(path):
            failed += 1
            print(f"{path}: {'.'.join(map(str, e.absolute_path))}: {e.message[:200]}")
    for name in VISIBLE:
        if not errors(pathlib.Path(bad) / f"{name}.yaml"):
            failed += 1
            print(f"{name}.yaml passes the schema")
    print(f"{len(files)} scenes, {len(VISIBLE)} bad scenes, {failed} surprises")
    return 1 if failed or not files else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
