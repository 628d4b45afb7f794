// The panel "Share". It shows the viewers' link as text and as a QR code for a projector. A
// presenter also sees the session's rules, and a link with which another person can present.

import { useMemo, useState } from "preact/hooks";
import qrcode from "qrcode-generator";
import type { SessionRules } from "../gen/thunderhead/v1/interact_pb";
import { OnlyHere } from "./only_here";
import type { Page } from "./page";
import { Popover } from "./popover";

type RuleName = Exclude<keyof SessionRules, "$typeName" | "$unknown">;

const RULES: readonly (readonly [RuleName, string, string])[] = [
  [
    "viewersMaySteer",
    "Viewers may steer",
    "While no one steers, a viewer who asks gets control at once.",
  ],
  [
    "controlLocked",
    "Control locked",
    "No one can ask for control, and viewers can give it only to presenters.",
  ],
  ["followingLocked", "Following locked", "Everyone sees your view, and no one can look around."],
  ["viewersMayMark", "Viewers may point and draw", "Everyone sees their pointers and lines."],
  ["freeWhenAway", "Free when away", "Control becomes free once you have been away for a minute."],
];

// Width of the empty margin (quiet zone) around the QR code, in modules, as ISO 18004 requires. A
// module is one square of the code.
const QUIET = 4;

export function Share({ page }: { page: Page }) {
  const link = page.addresses.viewersLink();
  if (link === undefined) return null;
  return (
    <Popover page={page} name="share" title="Share" label="Share this session">
      <p class="quiet">Anyone with this link can watch with you. Click the code to enlarge it.</p>
      <OnlyHere host={page.addresses.loopbackHost} />
      <QrCode text={link} />
      <LinkRow who="viewers" link={link} copyId="copy-link" copy={() => void page.copyLink()} />
      <button
        type="button"
        class="to-people"
        data-testid="share-people"
        onClick={() => page.togglePopover("people")}
      >
        Who is here: {page.state.session.people.value.length}
      </button>
      {page.state.session.presenting.value && (
        <>
          <Rules page={page} />
          <PresentersLink page={page} />
          <EndSession page={page} />
        </>
      )}
    </Popover>
  );
}

interface LinkRowProps {
  readonly who: "viewers" | "presenters";
  readonly link: string;
  readonly copyId: string;
  copy(): void;
}

// A row with a link as text and a button that copies it.
function LinkRow({ who, link, copyId, copy }: LinkRowProps) {
  return (
    <div class="link-row">
      <input
        type="text"
        class="link"
        readOnly
        aria-label={`Link for ${who}`}
        data-testid={`${who}-link`}
        value={link}
        onFocus={(event) => event.currentTarget.select()}
      />
      <button type="button" data-testid={copyId} onClick={copy}>
        Copy link
      </button>
    </div>
  );
}

// The presenter's link. It is folded because people who watch the screen must not read it.
function PresentersLink({ page }: { page: Page }) {
  const [open, setOpen] = useState(false);
  const link = page.addresses.presentersLink();
  if (link === undefined) return null;
  return (
    <details
      class="presenters-link"
      data-testid="present-too"
      onToggle={(event) => setOpen(event.currentTarget.open)}
    >
      <summary>Presenter's link</summary>
      {open && (
        <>
          <p class="quiet">
            Anyone who opens it can present as you do: take control, set the rules and end the
            session. It is for your second device or a colleague, not for the class.
          </p>
          <LinkRow
            who="presenters"
            link={link}
            copyId="copy-presenters-link"
            copy={() => void page.copyPresentersLink()}
          />
        </>
      )}
    </details>
  );
}

// A QR code. A click enlarges it to the window's size, for people at the back.
function QrCode({ text }: { text: string }) {
  const [large, setLarge] = useState(false);
  const { size, path } = useMemo(() => qrPath(text), [text]);
  return (
    <button
      type="button"
      class={large ? "qr large" : "qr"}
      aria-pressed={large}
      aria-label="QR code of the link, larger"
      title={large ? "Smaller" : "Larger"}
      data-testid="qr"
      onClick={() => setLarge(!large)}
    >
      <svg
        class="qr-code"
        viewBox={`0 0 ${size} ${size}`}
        shape-rendering="crispEdges"
        aria-hidden="true"
      >
        <rect width={size} height={size} fill="#fff" />
        <path d={path} fill="#000" />
      </svg>
      {large && <span class="qr-text">{text}</span>}
    </button>
  );
}

// Returns the dark modules as one path. A module is one unit wide.
function qrPath(text: string): { size: number; path: string } {
  const code = qrcode(0, "M");
  code.addData(text);
  code.make();
  const count = code.getModuleCount();
  let path = "";
  for (let row = 0; row < count; row += 1) {
    for (let column = 0; column < count; column += 1) {
      if (code.isDark(row, column)) path += `M${column + QUIET} ${row + QUIET}h1v1h-1z`;
    }
  }
  return { size: count + 2 * QUIET, path };
}

function Rules({ page }: { page: Page }) {
  const rules = page.state.session.rules.value;
  return (
    <fieldset class="rules">
      <legend>Rules</legend>
      {RULES.map(([name, label, about]) => (
        <label key={name} class="rule">
          <input
            type="checkbox"
            data-testid={`rule-${name}`}
            checked={rules[name] ?? false}
            onChange={(event) => page.actions.setRules({ [name]: event.currentTarget.checked })}
          />
          <span>
            {label}
            <span class="quiet">{about}</span>
          </span>
        </label>
      ))}
    </fieldset>
  );
}

// The button that ends the session. The first click asks for confirmation.
function EndSession({ page }: { page: Page }) {
  const [asked, setAsked] = useState(false);
  return (
    <button
      type="button"
      class="danger"
      data-testid="end-session"
      onBlur={() => setAsked(false)}
      onClick={() => (asked ? void page.actions.endSession() : setAsked(true))}
    >
      {asked ? "End it for everyone?" : "End session"}
    </button>
  );
}
