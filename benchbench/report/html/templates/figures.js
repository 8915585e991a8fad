"use strict";
// Draws the figures, and the plan that is open; one 3D view at a time, since browsers allow few.
(async () => {
  // gzip in base64: a page with everything in it would be three times as large
  const unpacked = (element) => {
    const bytes = Uint8Array.from(atob(element.textContent), (letter) => letter.charCodeAt(0));
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
  };

  const library = document.createElement("script");
  library.textContent = await unpacked(document.getElementById("plotly"));
  document.head.append(library);

  for (const place of document.querySelectorAll(".figure")) {
    const figure = JSON.parse(place.firstElementChild.textContent);
    place.replaceChildren();
    Plotly.newPlot(place, figure);
  }

  const moveCursor = (limits, time) => {
    const change = {};
    limits.layout.shapes.forEach((shape, i) => {
      if (shape.name === "cursor") change[`shapes[${i}].x0`] = change[`shapes[${i}].x1`] = time;
    });
    Plotly.relayout(limits, change);
  };

  // the picture is as wide as it is high; a narrow page needs more distance
  const fitted = (figure, width) => {
    const eye = figure.layout.scene.camera.eye, distance = Math.max(1, 560 / width);
    for (const axis of ["x", "y", "z"]) eye[axis] *= distance;
    return figure;
  };

  const open = async (plan) => {
    if (!plan.querySelector(".view")) return; // a plan for which there was no room
    const view = plan.querySelector(".view"), limits = plan.querySelector(".limits");
    const [shown, limited] = await Promise.all([".view-data", ".limits-data"].map((name) => unpacked(plan.querySelector(name))));
    if (!plan.open) return; // closed meanwhile
    await Plotly.newPlot(limits, JSON.parse(limited));
    await Plotly.newPlot(view, fitted(JSON.parse(shown), view.clientWidth));
    view.on("plotly_animatingframe", (event) => moveCursor(limits, Number(event.name)));
    plan.dataset.drawn = "yes";
  };

  const close = (plan) => {
    for (const place of plan.querySelectorAll(".view, .limits")) Plotly.purge(place);
    delete plan.dataset.drawn;
  };

  for (const plan of document.querySelectorAll("details.plan")) {
    plan.addEventListener("toggle", () => (plan.open ? open(plan) : close(plan)));
    if (plan.open) open(plan);
  }
})();
