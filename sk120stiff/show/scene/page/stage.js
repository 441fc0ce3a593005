// The room: Meshcat's viewer with our light, floor and robot in its tree.
"use strict";
SK.makeStage = (pane, scene) => {
  const THREE = MeshCat.THREE;
  const { reach } = scene.scale;
  const viewer = new MeshCat.Viewer(pane);
  const materials = SK.makeMaterials(), shapes = SK.makeShapes(scene);
  const fog = materials.linear(SK.colours.fog);

  viewer.gui.domElement.style.display = "none"; // our panel takes the place of Meshcat's
  viewer.renderer.outputEncoding = THREE.sRGBEncoding;
  viewer.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
  viewer.renderer.domElement.setAttribute("aria-hidden", "true");
  // Meshcat takes the height of the window; our pane is smaller than that.
  viewer.set_3d_pane_size = (width, height) => MeshCat.Viewer.prototype.set_3d_pane_size.call(
    viewer, width || pane.clientWidth, height || pane.clientHeight);
  new ResizeObserver(() => viewer.set_3d_pane_size()).observe(pane);

  for (const path of ["Grid", "Axes", "Background"]) viewer.set_property([path], "visible", false);
  viewer.hide_background();
  viewer.set_property(["Lights"], "visible", false);
  viewer.scene.fog = new THREE.Fog(fog, 3.2 * reach, 9 * reach);

  // Meshcat turns its scene so that z points up on the screen; three.js itself has y up.
  const toWorld = ([x, y, z]) => new THREE.Vector3(x, z, -y);
  const fromWorld = ({ x, y, z }) => [x, -z, y];

  const find = (path) => viewer.scene_tree.find(path);
  function put(path, object) {
    object.castShadow = object.castShadow === true;
    viewer.set_object(path, object);
  }
  function move(path, matrix) { find(path).set_transform(matrix); }
  function show(path, visible) { find(path).object.visible = visible; }

  // Light: a bright sky, a key light that casts shadows, a fill from the other side.
  const sky = new THREE.HemisphereLight(0xffffff, materials.linear("#b9c4cf"), 0.78);
  sky.position.set(0, 0, 1);
  put(["room", "sky"], sky);
  const key = new THREE.DirectionalLight(0xffffff, 0.62);
  key.position.set(0.9 * reach, -1.5 * reach, 2.4 * reach);
  key.shadow.mapSize.set(1024, 1024);
  key.shadow.radius = 7;
  key.shadow.bias = -0.0006;
  key.shadow.normalBias = 0.004 * reach;
  Object.assign(key.shadow.camera, {
    left: -1.5 * reach, right: 1.5 * reach, top: 1.5 * reach, bottom: -1.5 * reach, near: 0.1 * reach, far: 6 * reach,
  });
  put(["room", "key"], key);
  key.castShadow = true;
  const fill = new THREE.DirectionalLight(materials.linear("#dbe8f5"), 0.28);
  fill.position.set(-1.4 * reach, 1.2 * reach, 0.8 * reach);
  put(["room", "fill"], fill);

  // The robot, its deflected twin, and what stands around: no part of the arm, and of no twin.
  const nodes = { robot: [], deflected: [], around: [] }, marked = new Set(scene.marks.map(([link]) => link));
  scene.links.forEach((name, link) => {
    for (const [group, list] of Object.entries(nodes)) {
      const around = group === "around";
      const mine = scene.bodies.filter((body) => body.link === link && Boolean(body.still) === around);
      const path = [group, String(link) + " " + name.replaceAll("/", "_")];
      list.push(mine.length ? find(path) : null);
      mine.forEach((body, k) => {
        const twin = group === "deflected";
        const mesh = new THREE.Mesh(shapes.geometryOf(body), twin ? (marked.has(link) ? materials.namedGhost : materials.ghost) : !around && marked.has(link) ? materials.named : materials.body(body.colour));
        if (body.kind === "mesh") mesh.scale.fromArray(body.size);
        mesh.castShadow = mesh.receiveShadow = !twin && !around;
        viewer.set_object(path.concat(String(k)), mesh);
        move(path.concat(String(k)), body.matrix);
      });
    }
  });
  const placeLinks = (group, matrices) => matrices.forEach((matrix, k) => nodes[group][k] && nodes[group][k].set_transform(matrix));

  // A twin that hardly leaves its link would only flicker through it.
  function placeTwin(matrices, originals) {
    placeLinks("deflected", matrices);
    matrices.forEach((matrix, k) => {
      if (!nodes.deflected[k]) return;
      const apart = matrix.map((value, i) => Math.abs(value - originals[k][i]));
      const moved = Math.max(...apart.slice(12, 15)) + 0.1 * reach * Math.max(...apart.slice(0, 11));
      nodes.deflected[k].object.visible = moved > 0.003 * reach;
    });
  }

  function bounds() {
    viewer.scene.updateMatrixWorld(true);
    const box = new THREE.Box3().setFromObject(find(["robot"]).object);
    if (box.isEmpty()) box.setFromCenterAndSize(toWorld([0, 0, reach / 2]), toWorld([reach, -reach, reach]));
    return box;
  }

  // The floor lies under the robot's lowest part at its first pose, and stays there.
  function layFloor() {
    const height = bounds().min.y - 0.0005 * reach;
    const floor = new THREE.Mesh(new THREE.CircleGeometry(9 * reach, 64), new THREE.ShadowMaterial({ opacity: Number(SK.colours.shade) }));
    floor.receiveShadow = true;
    viewer.set_object(["room", "floor"], floor);
    const step = 10 ** Math.round(Math.log10(reach / 4)), count = 2 * Math.ceil((4 * reach) / step);
    const grid = new THREE.GridHelper(count * step, count, materials.linear(SK.colours.grid), materials.linear(SK.colours["grid-fine"]));
    grid.material.transparent = true;
    grid.material.opacity = 0.55;
    grid.rotateX(Math.PI / 2);
    put(["room", "grid"], grid);
    for (const name of ["floor", "grid"]) move(["room", name], [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, height, 1]);
    key.target.position.copy(toWorld([0, 0, height]));
    key.target.updateMatrixWorld();
    return step;
  }

  return { viewer, toWorld, fromWorld, materials, shapes, put, move, show, placeLinks, placeTwin, bounds, layFloor, reach, pane };
};
