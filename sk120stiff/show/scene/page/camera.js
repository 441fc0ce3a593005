// Camera presets, keyboard control, and a picture of what is seen.
"use strict";
SK.makeCamera = (stage) => {
  const THREE = MeshCat.THREE;
  const { viewer, reach, pane, toWorld } = stage;
  const camera = new THREE.PerspectiveCamera(34, 1, 0.02 * reach, 60 * reach);
  viewer.controls.dispose();
  viewer.set_object(["Cameras", "default", "rotated"], camera); // undoes the turn of the scene
  viewer.set_camera(camera);
  Object.assign(viewer.controls, { minDistance: 0.1 * reach, maxDistance: 12 * reach, zoomSpeed: 0.8, rotateSpeed: 0.7 });
  const calm = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
  let flight = 0, flying = false;

  function look(position, target, smoothly = true) {
    const mine = ++flight, from = camera.position.clone(), fromTarget = viewer.controls.target.clone();
    const begin = performance.now(), span = smoothly && !calm ? 420 : 0;
    const step = () => {
      if (mine !== flight) return;
      const t = span ? Math.min(1, (performance.now() - begin) / span) : 1, ease = t * t * (3 - 2 * t);
      camera.position.lerpVectors(from, position, ease);
      viewer.controls.target.lerpVectors(fromTarget, target, ease);
      viewer.controls.update();
      viewer.set_dirty();
      flying = t < 1;
      if (flying) requestAnimationFrame(step);
    };
    flying = true;
    step();
  }

  const views = {
    overview: [1.15, -1.3, 0.62],
    front: [1, 0, 0.08],
    side: [0, -1, 0.06],
    top: [0.02, 0, 1],
  };

  // A ball around the robot, what is marked at the point, and the floor under them.
  function whole(point) {
    const box = stage.bounds();
    if (point) box.union(new THREE.Box3().setFromCenterAndSize(toWorld(point), new THREE.Vector3().setScalar(0.3 * reach)));
    const ball = box.getBoundingSphere(new THREE.Sphere());
    return ball;
  }

  let current = "overview"; // the preset in force, until the reader turns the picture
  function preset(name, point, smoothly = true) {
    current = name;
    const aspect = pane.clientWidth / Math.max(1, pane.clientHeight);
    const half = (camera.fov * Math.PI) / 360, narrow = Math.min(half, Math.atan(Math.tan(half) * aspect));
    if (name === "tool") {
      const target = toWorld(point), away = toWorld([1, -1.15, 0.55]).normalize();
      look(target.clone().addScaledVector(away, (0.3 * reach) / Math.sin(narrow)), target, smoothly);
      return;
    }
    const ball = whole(point), away = toWorld(views[name]).normalize();
    look(ball.center.clone().addScaledVector(away, (0.9 * ball.radius) / Math.sin(narrow)), ball.center, smoothly);
  }

  // The reader takes the camera: no flight goes on, and no pose moves it.
  function release() { flight++; flying = false; current = ""; }

  pane.addEventListener("keydown", (event) => {
    const turn = { ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[event.key];
    const zoom = { "+": 0.9, "=": 0.9, "-": 1.1 }[event.key];
    if (!turn && !zoom) return;
    event.preventDefault();
    release();
    const offset = camera.position.clone().sub(viewer.controls.target);
    if (zoom) offset.multiplyScalar(zoom);
    else {
      const ball = new THREE.Spherical().setFromVector3(offset);
      ball.theta += turn[0];
      ball.phi = Math.min(3.05, Math.max(0.09, ball.phi + turn[1]));
      offset.setFromSpherical(ball);
    }
    camera.position.copy(viewer.controls.target).add(offset);
    viewer.controls.update();
    viewer.set_dirty();
  });
  pane.addEventListener("pointerdown", release);
  pane.addEventListener("wheel", release, { passive: true });
  const follow = (point) => { if (current) preset(current, point); };

  // What is seen, with its background and labels, as a canvas.
  function still() {
    viewer.render();
    const source = viewer.renderer.domElement, canvas = document.createElement("canvas");
    canvas.width = source.width;
    canvas.height = source.height;
    const brush = canvas.getContext("2d"), ratio = source.width / pane.clientWidth;
    const wash = brush.createLinearGradient(0, 0, 0, canvas.height);
    wash.addColorStop(0, SK.colours["sky-top"]);
    wash.addColorStop(1, SK.colours["sky-low"]);
    brush.fillStyle = wash;
    brush.fillRect(0, 0, canvas.width, canvas.height);
    brush.drawImage(source, 0, 0);
    const origin = pane.getBoundingClientRect();
    for (const element of pane.querySelectorAll(".label")) {
      if (element.style.display === "none") continue;
      const box = element.getBoundingClientRect(), style = getComputedStyle(element);
      brush.font = `${style.fontWeight} ${parseFloat(style.fontSize) * ratio}px ${style.fontFamily}`;
      brush.textAlign = "center";
      brush.textBaseline = "middle";
      const x = (box.left - origin.left + box.width / 2) * ratio, y = (box.top - origin.top + box.height / 2) * ratio;
      brush.lineWidth = 4 * ratio;
      brush.strokeStyle = SK.colours.paper;
      brush.strokeText(element.textContent, x, y);
      brush.fillStyle = style.color;
      brush.fillText(element.textContent, x, y);
    }
    return canvas;
  }
  const picture = () => still().toDataURL("image/png");

  // Paper gets a still: a canvas that WebGL draws on would come out blank.
  window.addEventListener("beforeprint", () => {
    const drawn = still(), sheet = document.getElementById("still");
    sheet.width = drawn.width;
    sheet.height = drawn.height;
    sheet.getContext("2d").drawImage(drawn, 0, 0);
  });

  return { preset, follow, busy: () => flying, picture, still, names: [...Object.keys(views), "tool"] };
};
