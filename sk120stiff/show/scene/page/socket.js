// The physics of the live page: one request at a time to the server, the newest always last.
"use strict";
SK.makeSocket = (address, onState) => {
  let socket = null, waiting = null, inFlight = null, number = 0, pause = 500;

  function send() {
    if (!waiting || inFlight || !socket || socket.readyState !== WebSocket.OPEN) return;
    inFlight = waiting;
    waiting = null;
    inFlight.id = ++number;
    inFlight.sent = performance.now();
    const { a, wrench, point, exaggeration } = inFlight.state;
    socket.send(JSON.stringify({ id: inFlight.id, a, wrench, point, exaggeration }));
  }

  function connect() {
    socket = new WebSocket(address);
    socket.onopen = () => { pause = 500; onState("open"); send(); };
    socket.onmessage = (message) => {
      const answer = JSON.parse(message.data);
      if (!inFlight || (answer.id !== null && answer.id !== inFlight.id)) return;
      const { done, sent } = inFlight;
      inFlight = null;
      if (answer.frame) { SK.roundTrip = performance.now() - sent; onState("open"); done(answer.frame); }
      else onState("refused", answer.error);
      send();
    };
    socket.onclose = () => {
      if (inFlight && !waiting) waiting = inFlight;
      inFlight = null;
      onState("closed");
      setTimeout(connect, pause);
      pause = Math.min(2 * pause, 8000);
    };
  }
  connect();

  return {
    request(state, done) {
      waiting = { state: { ...state }, done };
      send();
    },
  };
};
