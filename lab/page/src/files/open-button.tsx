// Button to choose files, as an alternative to dropping them.

import { useRef } from "preact/hooks";

export function OpenButton({ name, accept, open, id }: { name: string; accept: string; open: (files: File[]) => void; id: string }) {
  const input = useRef<HTMLInputElement>(null);
  return (
    <>
      <button onClick={() => input.current?.click()}>{name}</button>
      <input
        ref={input}
        id={id}
        type="file"
        accept={accept}
        multiple
        hidden
        aria-label={name}
        onChange={(event) => {
          open([...(event.currentTarget.files ?? [])]);
          event.currentTarget.value = "";
        }}
      />
    </>
  );
}
