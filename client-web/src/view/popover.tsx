// The panel that a button of the top bar opens. The panel takes the keyboard focus when it opens,
// and returns the focus when it closes.
import type { ComponentChildren } from "preact";
import { useLayoutEffect, useRef } from "preact/hooks";
import type { PanelName } from "../core/tools";
import type { Page } from "./page";

interface PopoverProps {
  readonly page: Page;
  readonly name: PanelName;
  readonly title: string;
  readonly label: string;
  readonly children: ComponentChildren;
}

export function Popover({ page, name, title, label, children }: PopoverProps) {
  const dialog = useRef<HTMLElement>(null);
  // A layout effect is used because the focus must change before the next key is handled.
  useLayoutEffect(() => {
    const before = document.activeElement;
    dialog.current?.focus();
    return () => {
      if (before instanceof HTMLElement) before.focus();
    };
  }, []);
  return (
    <section
      id={name}
      ref={dialog}
      class={`popover ${name}`}
      role="dialog"
      aria-label={label}
      tabIndex={-1}
      data-testid={`${name}-panel`}
    >
      <header>
        <h2>{title}</h2>
        <button
          type="button"
          class="close"
          aria-label="Close"
          onClick={() => page.togglePopover(name)}
        >
          ×
        </button>
      </header>
      <div class="popover-body">{children}</div>
    </section>
  );
}
