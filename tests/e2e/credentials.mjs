// Creates certificates and tokens for a server that requires them.
import { execFileSync } from "node:child_process";
import { createHash } from "node:crypto";

// Writes a self-signed certificate for this machine, valid for two days, and its key into those files.
export function writeCertificate(certificate, key) {
  execFileSync("openssl", [
    ..."req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 2 -subj /CN=localhost".split(" "),
    ...["-addext", "subjectAltName=DNS:localhost,IP:127.0.0.1", "-keyout", key, "-out", certificate],
  ], { stdio: "ignore" });
}

export const digest = (token) => createHash("sha256").update(token).digest("hex");
