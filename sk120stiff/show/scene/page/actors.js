// Everything that is not the robot: ellipsoids, arrows, frames, and the labels in front of them.
"use strict";
SK.makeActors = (stage, scene) => {
  const THREE = MeshCat.THREE, m = SK.algebra;
  const { put, move, show, materials, shapes, reach, viewer } = stage;
  const { colours } = SK;
  const thin = 0.0028 * reach;
  const labels = [];
  const layer = document.createElement("div");
  layer.className = "labels";
  layer.setAttribute("aria-hidden", "true");
  stage.pane.append(layer);

  // A transform that takes z to a direction, with a scale across and along it.
  function along(from, direction, across, length) {
    const z = m.scaled(direction, 1 / (m.norm(direction) || 1));
    const other = Math.abs(z[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0];
    let x = m.cross(other, z);
    x = m.scaled(x, 1 / m.norm(x));
    const y = m.cross(z, x);
    return [...m.scaled(x, across), 0, ...m.scaled(y, across), 0, ...m.scaled(z, length), 0, ...from, 1];
  }

  function mark(path, geometry, material, order) {
    const mesh = new THREE.Mesh(geometry, material);
    mesh.renderOrder = order;
    put(path, mesh);
  }

  function makeLabel(kind) {
    const element = document.createElement("span");
    element.className = "label " + kind;
    layer.append(element);
    const label = { element, at: null };
    labels.push(label);
    return {
      set(at, text) { label.at = at; if (element.textContent !== text) element.textContent = text; },
      hide() { label.at = null; },
    };
  }

  function makeArrow(name, colour, { doubled = false, label = "" } = {}) {
    const path = ["marks", name], material = materials.flat(colour), words = makeLabel("arrow");
    mark(path.concat("shaft"), shapes.shaft(1.5 * thin), material, 6);
    mark(path.concat("head"), shapes.cone(4.6 * thin, 14 * thin), material, 6);
    if (doubled) mark(path.concat("second"), shapes.cone(4.6 * thin, 14 * thin), material, 6);
    show(path, false);
    return {
      set(from, vector, text = label) {
        const length = m.norm(vector);
        const visible = length > 0.5 * thin;
        show(path, visible);
        if (!visible) { words.hide(); return; }
        const direction = m.scaled(vector, 1 / length);
        const size = Math.min(1, length / (20 * thin)), head = 14 * thin * size;
        move(path.concat("shaft"), along(from, direction, size, Math.max(length - head, 1e-6)));
        move(path.concat("head"), along(m.add(from, m.scaled(direction, length - head)), direction, size, size));
        if (doubled) move(path.concat("second"), along(m.add(from, m.scaled(direction, length - 1.9 * head)), direction, size, size));
        if (text && length > 0.03 * reach) words.set(m.add(from, m.scaled(direction, length + 5 * thin)), text);
        else words.hide();
      },
      hide() { show(path, false); words.hide(); },
    };
  }

  function makeFrame(name, size) {
    const arrows = ["x", "y", "z"].map((axis, k) => {
      const colour = [colours.vermilion, colours.green, colours.blue][k];
      return makeArrow(name + "_" + axis, colour, { label: axis });
    });
    return {
      set(position, rotation, visible) {
        arrows.forEach((arrow, k) => (visible
          ? arrow.set(position, m.scaled([0, 1, 2].map((i) => rotation[3 * k + i]), size))
          : arrow.hide()));
      },
    };
  }

  // An ellipsoid with its principal axes. Radii are metres in the room.
  function makeEllipsoid(name, colour, filled) {
    const path = ["ellipsoid", name];
    if (filled) {
      const sphere = new THREE.Mesh(new THREE.SphereGeometry(1, 64, 40), materials.glass(colour, 0.3));
      sphere.renderOrder = 2;
      put(path.concat("surface", "skin"), sphere);
    }
    put(path.concat("surface", "rings"), new THREE.LineSegments(shapes.circles(), materials.line(colour, filled ? 0.75 : 0.95)));
    const axes = [0, 1, 2].map((k) => {
      const line = path.concat("axis" + k);
      mark(line.concat("line"), shapes.shaft(filled ? thin : 0.6 * thin), materials.flat(colour), 4);
      mark(line.concat("ends", "a"), shapes.cone(3 * thin, 7 * thin), materials.flat(colour), 4);
      mark(line.concat("endb", "b"), shapes.cone(3 * thin, 7 * thin), materials.flat(colour), 4);
      return { line, words: filled ? makeLabel("value") : null };
    });
    function hide() {
      show(path, false);
      axes.forEach((axis) => axis.words && axis.words.hide());
    }
    return {
      hide,
      // halves: drawn half lengths; whole: false leaves only the axes (no ellipsoid exists).
      set(centre, directions, halves, { whole, texts, capped }) {
        show(path, true);
        show(path.concat("surface"), whole);
        const [x, y] = directions;
        let z = directions[2];
        if (m.dot(m.cross(x, y), z) < 0) z = m.scaled(z, -1);
        const least = 0.0015 * reach;
        const columns = [x, y, z].map((axis, k) => m.scaled(axis, Math.max(halves[k], least)));
        move(path.concat("surface"), [...columns[0], 0, ...columns[1], 0, ...columns[2], 0, ...centre, 1]);
        directions.forEach((direction, k) => {
          const half = Math.max(halves[k], least), tip = m.scaled(direction, half);
          move(axes[k].line.concat("line"), along(m.minus(centre, tip), direction, 1, 2 * half));
          for (const [end, sign] of [["ends", 1], ["endb", -1]]) {
            show(axes[k].line.concat(end), capped[k]);
            move(axes[k].line.concat(end), along(m.add(centre, m.scaled(tip, sign)), m.scaled(direction, sign), 1, 1));
          }
          if (axes[k].words) {
            // The label stands at the end that is nearer to the camera.
            const toEye = m.minus(stage.fromWorld(viewer.camera.position), centre);
            const sign = m.dot(direction, toEye) < 0 ? -1 : 1;
            axes[k].words.set(m.add(centre, m.scaled(direction, sign * (half + 8 * thin))), texts[k]);
          }
        });
      },
    };
  }

  // Project labels after every picture, and move those apart that would cover each other.
  const overlap = (a, b) => Math.abs(a.x - b.x) < (a.width + b.width) / 2 + 6 && Math.abs(a.y - b.y) < 17;
  function spread(boxes) {
    const placed = [];
    for (const box of boxes) {
      const start = box.y;
      for (let step = 1; step < 22 && placed.some((other) => overlap(box, other)); step++)
        box.y = start + (step % 2 ? 1 : -1) * Math.ceil(step / 2) * 6;
      placed.push(box);
    }
  }
  const render = viewer.render.bind(viewer), spot = new THREE.Vector3();
  viewer.render = () => {
    if (!SK.drawn) return; // nothing has its place yet: no shader is worth compiling
    render();
    const width = stage.pane.clientWidth, height = stage.pane.clientHeight;
    const boxes = [];
    for (const { element, at } of labels) {
      const empty = !at || !element.textContent;
      if (!empty) spot.copy(stage.toWorld(at)).project(viewer.camera);
      const inside = !empty && spot.z < 1 && Math.abs(spot.x) < 1.05 && Math.abs(spot.y) < 1.05;
      element.style.display = inside ? "" : "none";
      if (inside) boxes.push({ element, x: ((spot.x + 1) / 2) * width, y: ((1 - spot.y) / 2) * height, width: 6.9 * element.textContent.length });
    }
    for (const box of boxes) box.x = Math.max(box.width / 2 + 4, Math.min(width - box.width / 2 - 4, box.x));
    spread(boxes);
    for (const { element, x, y } of boxes) element.style.transform = `translate(-50%, -50%) translate(${x}px, ${y}px)`;
  };

  // Where a point is seen, in pixels of the pane.
  function screenOf(at) {
    stage.viewer.camera.updateMatrixWorld();
    spot.copy(stage.toWorld(at)).project(viewer.camera);
    return [((spot.x + 1) / 2) * stage.pane.clientWidth, ((1 - spot.y) / 2) * stage.pane.clientHeight];
  }

  return { makeArrow, makeFrame, makeEllipsoid, makeLabel, labels, screenOf };
};
