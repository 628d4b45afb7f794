// Asks for the token that the server requires.
import { useSignal } from "@preact/signals";
import { isToken } from "../core/access_token";
import type { Page } from "./page";

export function SignIn({ page }: { page: Page }) {
  const connection = page.state.connection.value;
  const typed = useSignal("");
  if (connection.kind !== "locked") return null;
  const signIn = (event: Event) => {
    event.preventDefault();
    const token = typed.value;
    typed.value = "";
    if (isToken(token)) page.signIn(token);
  };
  return (
    <form class="ended sign-in" aria-label="Sign in" data-testid="sign-in" onSubmit={signIn}>
      <p role="alert">{connection.reason.replace(/[.:;].*$/, "")}.</p>
      <label>
        Token{" "}
        <input
          type="password"
          autocomplete="off"
          data-testid="token"
          value={typed.value}
          onInput={(event) => {
            typed.value = event.currentTarget.value;
          }}
        />
      </label>
      <button type="submit" disabled={!isToken(typed.value)}>
        Sign in
      </button>
    </form>
  );
}
