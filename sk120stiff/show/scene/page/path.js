// A path: as it was given and as it is placed, its weakest point, and the freedom that was searched.
"use strict";
SK.makePath = (stage, actors, path) => {
  const THREE = MeshCat.THREE, { reach, materials } = stage;
  function draw(name, points, colour) {
    const put = (key, geometry, at) => {
      const mesh = new THREE.Mesh(geometry, materials.flat(colour));
      mesh.renderOrder = 5;
      stage.put(["path", name, key], mesh);
      stage.move(["path", name, key], [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, ...at, 1]);
    };
    const vectors = points.map((point) => new THREE.Vector3(...point));
    const curve = new THREE.CurvePath();
    vectors.slice(1).forEach((point, k) => { if (point.distanceTo(vectors[k]) > 0) curve.add(new THREE.LineCurve3(vectors[k], point)); });
    if (curve.curves.length) put("line", new THREE.TubeGeometry(curve, Math.min(2000, 4 * points.length), 0.0035 * reach, 8), [0, 0, 0]);
    const every = Math.ceil(points.length / 40);
    points.forEach((point, k) => { if (path.stops.length ? path.stops.includes(k) : k % every === 0) put("dot" + k, new THREE.SphereGeometry(0.007 * reach, 12, 8), point); });
  }
  const { colours } = SK;
  if (path.moved) draw("before", path.before, colours.before);
  draw("after", path.after, colours.ink);
  const worst = new THREE.Mesh(new THREE.SphereGeometry(0.014 * reach, 20, 12), materials.flat(colours.soft));
  worst.renderOrder = 6;
  stage.put(["path", "worst"], worst);
  stage.move(["path", "worst"], [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, ...path.after[path.worst], 1]);
  actors.makeLabel("mark").set(path.after[path.worst], path.said);
  const robotBounds = stage.bounds, laid = path.after.map((point) => stage.toWorld(point));
  stage.bounds = () => robotBounds().union(new THREE.Box3().setFromPoints(laid)); // all of it is in the picture
  const free = materials.line(colours.yields, 0.9);
  if (path.box) {
    const sides = path.box.reach.map((half) => Math.max(2 * half, 0.004 * reach));
    stage.put(["path", "freedom"], new THREE.LineSegments(new THREE.EdgesGeometry(new THREE.BoxGeometry(...sides)), free));
    stage.move(["path", "freedom"], [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, ...path.box.middle, 1]);
  }
  if (path.turns) {
    const ring = new THREE.Mesh(new THREE.TorusGeometry(0.075 * reach, 0.003 * reach, 8, 64), materials.flat(colours.yields));
    ring.renderOrder = 4;
    stage.put(["path", "turn"], ring);
  }
  return {
    legend: [["path", path.moved ? "path as placed" : "path"], ...(path.moved ? [["before", "path as given"]] : []), ["worst", path.mark],
      ...(path.box || path.turns ? [["freedom", path.freedom]] : [])],
    // The ring stands about the tool's axis, wherever the tool is.
    follow({ position, rotation }) {
      if (path.turns) stage.move(["path", "turn"], [...rotation.slice(0, 3), 0, ...rotation.slice(3, 6), 0, ...rotation.slice(6, 9), 0, ...position, 1]);
    },
  };
};
