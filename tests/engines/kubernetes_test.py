"""Tests deploy/kubernetes: its objects against the published API schemas and the stricter kubernetes_schema.json, and
its exit codes against those of the program.
"""

import copy
import json
import pathlib
import shutil
import subprocess
import sys
import unittest

from engine_test import PROGRAM, ROOT, SKIPPED

try:
    import jsonschema
    import yaml
except ImportError as missing:
    print(f"SKIPPED: {missing}; ./dev install engines installs python3-jsonschema and python3-yaml")
    sys.exit(SKIPPED)

FOLDER = ROOT / "deploy/kubernetes"
SCHEMA = json.loads((pathlib.Path(__file__).parent / "kubernetes_schema.json").read_text())

VALIDATE = pathlib.Path(__file__).parent / "kubernetes_validate.mjs"


def objects(name: str) -> list[dict]:
    return list(yaml.safe_load_all((FOLDER / name).read_text()))


def published_errors(things: list[dict]) -> list[list[str]]:
    """Returns what is wrong with each object by the schemas that the API publishes."""
    done = subprocess.run(["node", VALIDATE], input=json.dumps(things), capture_output=True, text=True, timeout=6000)
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return json.loads(done.stdout)


def errors(thing: dict) -> list[str]:
    """Returns what is wrong with an object, each fault with its place."""
    schema = {**SCHEMA, "$ref": f"#/definitions/{thing['kind']}"}
    found = jsonschema.Draft7Validator(schema).iter_errors(thing)
    return [f"{'/'.join(str(part) for part in error.absolute_path)}: {error.message}" for error in found]


class Kubernetes(unittest.TestCase):
    def test_the_schema_is_one(self) -> None:
        jsonschema.Draft7Validator.check_schema(SCHEMA)

    def test_every_object_fits_it(self) -> None:
        kinds = []
        for file in sorted(FOLDER.glob("*.yaml")):
            for thing in objects(file.name):
                self.assertEqual(errors(thing), [], file.name)
                kinds.append(thing["kind"])
        self.assertEqual(sorted(kinds), ["Deployment", "Job", "Job"] + 3 * ["PersistentVolumeClaim"] + ["Service"])

    @unittest.skipUnless(shutil.which("node") and (VALIDATE.parent / "node_modules/kubernetes-models").is_dir(),
                         "the npm package kubernetes-models is not installed; ./dev test does that")
    def test_every_object_fits_the_published_schema(self) -> None:
        things = [thing for file in sorted(FOLDER.glob("*.yaml")) for thing in objects(file.name)]
        self.assertEqual(published_errors(things), [[] for _ in things])
        # The validator must find a mistake in each kind of object.
        for thing in things:
            thing["spec"].update({"Deployment": {"replicas": "2"}, "Job": {"backoffLimit": "3"}, "Service": {"ports": [{}]},
                                  "PersistentVolumeClaim": {"accessModes": "ReadWriteMany"}}[thing["kind"]])
        for thing, wrong in zip(things, published_errors(things)):
            self.assertNotEqual(wrong, [], thing["kind"])

    def test_mistakes_do_not_fit_it(self) -> None:
        def mistaken(change) -> list[str]:
            job = copy.deepcopy(objects("sequence.yaml")[0])
            change(job["spec"])
            return errors(job)

        for change in (
            lambda spec: spec.update(backofLimitPerIndex=3),
            lambda spec: spec.pop("backoffLimitPerIndex"),
            lambda spec: spec.update(completionMode="NonIndexed"),
            lambda spec: spec["podFailurePolicy"]["rules"][0].update(action="FailIndexes"),
            lambda spec: spec["podFailurePolicy"]["rules"][0]["onExitCodes"].update(values=["65"]),
            lambda spec: spec["template"]["spec"].update(restartPolicy="OnFailure"),
            lambda spec: spec["template"]["spec"]["containers"][0].update(arg=[]),
        ):
            self.assertNotEqual(mistaken(change), [])

    def test_the_job_is_of_one_piece(self) -> None:
        """Checks what a schema cannot: names that refer to other objects, and numbers that must agree."""
        spec = objects("sequence.yaml")[0]["spec"]
        container = spec["template"]["spec"]["containers"][0]
        environment = {variable["name"]: variable["value"] for variable in container["env"]}
        self.assertEqual(environment["JOB_COMPLETIONS"], str(spec["completions"]))
        for rule in spec["podFailurePolicy"]["rules"]:
            if "onExitCodes" in rule:
                self.assertEqual(rule["onExitCodes"]["containerName"], container["name"])
        volumes = {volume["name"] for volume in spec["template"]["spec"]["volumes"]}
        self.assertEqual({mount["name"] for mount in container["volumeMounts"]}, volumes)

    def test_the_movies_are_of_the_same_run(self) -> None:
        pods = [objects(name)[0]["spec"]["template"]["spec"] for name in ("sequence.yaml", "movie.yaml")]
        pictures, movie = [pod["containers"][0] for pod in pods]
        self.assertEqual([part for part in movie["args"] if not part.startswith("--movie=")], pictures["args"])
        self.assertEqual(pods[0]["volumes"], pods[1]["volumes"])
        self.assertEqual(movie["volumeMounts"], pictures["volumeMounts"])
        self.assertNotIn("JOB_COMPLETIONS", str(movie["env"]), "the movie's job is no share")

    def test_every_claim_is_defined_and_used(self) -> None:
        pods = [objects(name)[0]["spec"]["template"]["spec"] for name in ("sequence.yaml", "movie.yaml", "serve.yaml")]
        used = {volume["persistentVolumeClaim"]["claimName"] for pod in pods for volume in pod["volumes"]
                if "persistentVolumeClaim" in volume}
        self.assertEqual(used, {claim["metadata"]["name"] for claim in objects("claims.yaml")})

    def test_its_exit_codes_are_the_programs(self) -> None:
        rules = objects("sequence.yaml")[0]["spec"]["podFailurePolicy"]["rules"]
        action = {code: rule["action"] for rule in rules for code in rule.get("onExitCodes", {}).get("values", [])}
        self.assertEqual(action, {64: "FailJob", 65: "FailIndex", 78: "FailJob"})
        arguments = objects("sequence.yaml")[0]["spec"]["template"]["spec"]["containers"][0]["args"]
        arguments = [part.replace("/views/", f"{ROOT}/deploy/views/") for part in arguments]
        # Runs the command as the pod does, but without its storm. The expected exit code is 75, after which Kubernetes
        # tries again. An unknown flag would give 64.
        done = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, timeout=600,
                              env={"JOB_COMPLETION_INDEX": "1", "JOB_COMPLETIONS": "4"})
        self.assertEqual(done.returncode, 75, done.stderr)
        self.assertIn("/data/run42", done.stderr)


if __name__ == "__main__":
    unittest.main()
