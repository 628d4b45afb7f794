// A warning next to a link that only works on this computer.

// `host` is the host name in the link if other machines cannot open it, such as "localhost";
// otherwise undefined.
export function OnlyHere({ host }: { host: string | undefined }) {
  if (host === undefined) return null;
  return (
    <p class="only-here" role="note" data-testid="only-here">
      <strong>Others cannot open this link:</strong> {host} is only this computer. Start the server
      with <code>--http</code> on an address that they can reach, and open this page by that
      address.
    </p>
  );
}
