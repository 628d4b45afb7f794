// Reads the messages that a page sends over its WebSocket. It parses only the part of Protobuf's wire format that gives
// the kind of a message.
const MESSAGE = 0x00;
// Field number of InteractRequest.update_scene.
const UPDATE_SCENE = 3;
const VARINT = 0;

// Returns a function that returns how many scenes the page has sent so far. Call it before the page is opened.
export function countSceneUpdates(page) {
  let count = 0;
  page.on("websocket", (socket) =>
    socket.on("framesent", ({ payload }) => {
      if (fieldsOf(payload).includes(UPDATE_SCENE)) count += 1;
    }),
  );
  return () => count;
}

// Returns the field numbers of a request: the field of its id, and the field of its message.
function fieldsOf(payload) {
  const bytes = Buffer.from(payload);
  if (bytes[0] !== MESSAGE) return [];
  const fields = [];
  let at = 1;
  while (at < bytes.length) {
    const tag = bytes[at];
    fields.push(tag >> 3);
    // The id is a varint. Any other field is the message, which ends the request.
    if ((tag & 7) !== VARINT) break;
    at += 1;
    while (bytes[at] & 0x80) at += 1;
    at += 1;
  }
  return fields;
}
