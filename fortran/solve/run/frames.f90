!> The frame of an accepted increment that recorders see, made from the workspace.
module lopin_frames
   use lopin_kinds, only : wp
   use lopin_constraints, only : axes_at
   use lopin_model, only : model_type
   use lopin_report, only : frame_type, damage_field_type, contact_field_type
   use lopin_recover_stress, only : recover_stress, average_to_nodes
   use lopin_recover_nonlinear, only : recover_nonlinear
   use lopin_recorder, only : wants_type
   use lopin_vectors, only : cross
   use lopin_row_resultants, only : sum_places
   use lopin_small_displacements, only : turns
   use lopin_mean_gradient, only : own_motion
   use lopin_scene, only : scene_type
   use lopin_present_gaps, only : relative_motion, gap_of
   use lopin_row_samples, only : has_samples
   use lopin_methods, only : has_law
   use lopin_solid_memory, only : at_all_points
   use lopin_damage_criteria, only : damage_names
   use lopin_damage, only : damage_kinds, is_averaged, mean_damage
   use lopin_material_memory, only : strain_at
   use lopin_newton_workspace, only : is_nonlinear
   use lopin_nonlinear_results, only : nonlinear_contact_fields
   implicit none
   private
   public :: fill_frame

contains

   !> What recorders are shown of the trial state.
   subroutine fill_frame(frame, scene, model, reaction, wants)
      type(frame_type), intent(inout) :: frame
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: reaction(:)      !! (nprescribed) [force]
      type(wants_type), intent(in) :: wants
      real(wp), allocatable :: strain(:, :), stress(:, :)

      call nodal_values(frame, scene, model, reaction)
      if (scene%newton%in_use) then
         call nonlinear_contact_fields(frame%contact, frame%closed, scene, model)
      else
         call contact_values(frame, scene, model)
         call move_moments(frame, scene, model, reaction)
      end if
      frame%first_point = scene%solids%first_point
      if (scene%newton%flows) call plastic_values(frame, scene, model, wants)
      if (.not. (wants%stress .or. wants%strain .or. wants%nodal_stress)) return
      if (is_nonlinear(scene%newton)) then
         call recover_nonlinear(scene%solids, model%mesh, frame%u(:3, :), scene%newton%past, &
            & stress, strain)
      else
         call recover_stress(scene%solids, model%mesh, frame%u(:3, :), stress, strain)
      end if
      if (wants%nodal_stress) then
         if (.not. allocated(frame%nodal_stress)) allocate (frame%nodal_stress(6, model%mesh%nnode))
         call average_to_nodes(scene%solids, model%mesh, stress, frame%nodal_stress)
      end if
      if (wants%stress) call move_alloc(stress, frame%stress)
      if (wants%strain) call move_alloc(strain, frame%strain)
   end subroutine fill_frame

   !> Plastic strain at the points and, if stresses are wanted there, at the nodes.
   subroutine plastic_values(frame, scene, model, wants)
      type(frame_type), intent(inout) :: frame
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(wants_type), intent(in) :: wants
      integer :: nstress

      nstress = merge(6, 4, model%mesh%ndim == 3)
      frame%plastic_strain = reshape(at_all_points(scene%trial%solids, scene%solids, &
         & strain_at(nstress)), [1, frame%first_point(size(frame%first_point)) - 1])
      if (allocated(scene%trial%solids%damage)) call damage_values(frame%damage, scene, &
         & model, wants)
      if (.not. wants%nodal_stress) return
      if (.not. allocated(frame%nodal_plastic)) allocate (frame%nodal_plastic(1, model%mesh%nnode))
      call average_to_nodes(scene%solids, model%mesh, frame%plastic_strain, frame%nodal_plastic)
      frame%nodal_plastic = max(frame%nodal_plastic, 0.0_wp)
   end subroutine plastic_values

   !> Damage at the points and, if stresses are wanted there, at the nodes.
   subroutine damage_values(field, scene, model, wants)
      type(damage_field_type), allocatable, intent(inout) :: field(:)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(wants_type), intent(in) :: wants
      real(wp), allocatable :: mean(:, :)
      integer, allocatable :: kinds(:)
      integer :: k, e, n, p

      allocate (kinds, source=damage_kinds(model))
      if (.not. allocated(field)) allocate (field(size(kinds)))
      associate (solids => scene%solids, memory => scene%trial%solids)
         call mean_damage(solids, model, scene%trial%motion%u, memory, mean)
         do k = 1, size(kinds)
            field(k)%name = trim(damage_names(kinds(k)))
            field(k)%averaged = is_averaged(model, kinds(k))
            field(k)%most = maxval([0.0_wp, mean(k, :)])
            if (.not. allocated(field(k)%value)) &
               & allocate (field(k)%value(2, solids%first_point(model%mesh%nelement + 1) - 1))
            field(k)%value = 0.0_wp
            do e = 1, model%mesh%nelement
               n = memory%first(e + 1) - memory%first(e)
               p = solids%first_point(e)
               if (n == 0) cycle
               field(k)%value(1, p:p + n - 1) = memory%damage(2*k - 1, &
                  & memory%first(e):memory%first(e) + n - 1)
               field(k)%value(2, p:p + n - 1) = mean(k, memory%first(e):memory%first(e) + n - 1)
            end do
            if (.not. wants%nodal_stress) cycle
            if (.not. allocated(field(k)%nodal)) allocate (field(k)%nodal(2, model%mesh%nnode))
            call average_to_nodes(solids, model%mesh, field(k)%value, field(k)%nodal)
            field(k)%nodal = max(field(k)%nodal, 0.0_wp)
         end do
      end associate
   end subroutine damage_values

   subroutine nodal_values(frame, scene, model, reaction)
      type(frame_type), intent(inout) :: frame
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: reaction(:)
      integer :: i, k, node, dof, axes, before

      if (.not. allocated(frame%u)) allocate (frame%u(6, model%mesh%nnode), &
         & frame%rf(6, model%mesh%nnode))
      frame%u = 0.0_wp
      frame%rf = 0.0_wp
      do node = 1, model%mesh%nnode
         do k = 1, 6
            if (scene%dofs%id(k, node) > 0) frame%u(k, node) = scene%trial%motion%u( &
               & scene%dofs%id(k, node))
         end do
      end do
      do i = 1, size(reaction)
         node = scene%dofs%node(scene%constraints%dof_of_prescribed(i))
         dof = scene%dofs%dof(scene%constraints%dof_of_prescribed(i))
         axes = axes_at(scene%constraints, node, dof)
         before = merge(0, 3, dof <= 3)
         if (axes > 0) then
            frame%rf(before + 1:before + 3, node) = frame%rf(before + 1:before + 3, node) &
               & + reaction(i)*scene%constraints%axes(dof - before, :, axes)
         else
            frame%rf(dof, node) = frame%rf(dof, node) + reaction(i)
         end if
      end do
      do i = 1, size(model%rigid_body)
         node = model%rigid_body(i)%rotation
         if (node == 0) cycle
         frame%u(:3, node) = frame%u(4:6, model%rigid_body(i)%reference)
         frame%rf(:3, node) = frame%rf(4:6, model%rigid_body(i)%reference)
      end do
   end subroutine nodal_values

   !> Small sliding presses a tool where its slave was: along a plane the moment goes on with it.
   subroutine move_moments(frame, scene, model, reaction)
      type(frame_type), intent(inout) :: frame
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: reaction(:)
      integer :: pair, i, k, axes, dof, point
      real(wp) :: moment(3), way(3), axis(3)

      do pair = 1, size(model%pair)
         if (scene%points%tool(pair) == 0 .or. scene%points%body(pair) == 0) cycle
         associate (c => frame%contact(pair), &
            & reference => model%rigid_body(scene%points%body(pair))%reference)
            moment = 0.0_wp
            do i = 1, size(c%node)
               if (c%status(i) <= 0 .or. c%status(i) == 3) cycle
               point = scene%points%first(pair) + i - 1
               way = own_motion(scene, model, c%node(i))
               way = way - dot_product(way, scene%points%normal(:, point)) &
                  & *scene%points%normal(:, point)
               if (.not. any(abs(way) > 0.0_wp)) cycle
               if (turns(scene, model, point)) cycle
               axis = 0.0_wp
               axis(:size(c%force, 1)) = c%force(:, i)
               moment = moment + cross(way, axis)
            end do
            do k = 1, size(reaction)
               if (scene%dofs%node(scene%constraints%dof_of_prescribed(k)) /= reference) cycle
               dof = scene%dofs%dof(scene%constraints%dof_of_prescribed(k)) - 3
               if (dof < 1) cycle
               axes = axes_at(scene%constraints, reference, dof + 3)
               axis = 0.0_wp
               axis(dof) = 1.0_wp
               if (axes > 0) axis = scene%constraints%axes(dof, :, axes)
               frame%rf(4:6, reference) = frame%rf(4:6, reference) &
                  & + dot_product(axis, moment)*axis
            end do
            k = model%rigid_body(scene%points%body(pair))%rotation
            if (k > 0) frame%rf(:3, k) = frame%rf(4:6, reference)
         end associate
      end do
   end subroutine move_moments

   subroutine contact_values(frame, scene, model)
      type(frame_type), intent(inout) :: frame
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer :: pair, i, n, from, row, point, ndim
      real(wp) :: motion(3), across(scene%points%n)   ! forces of rows along their normals

      ndim = model%mesh%ndim
      frame%closed = 0
      if (.not. allocated(frame%contact)) allocate (frame%contact(size(model%pair)))
      do pair = 1, size(model%pair)
         from = scene%points%first(pair)
         n = scene%points%first(pair + 1) - from
         associate (c => frame%contact(pair), p => scene%points)
            if (.not. allocated(c%node)) allocate (c%node(n), c%facet(n), c%status(n), &
               & c%weight(n), c%gap(n), &
               & c%pressure(n), c%normal(ndim, n), c%force(ndim, n), c%xi(2, n), c%u_n(n), &
               & c%u_t(ndim, n), c%shear(ndim, n), c%couple(3, n))
            c%node = p%node(from:from + n - 1)
            c%facet = p%facet(from:from + n - 1)
            c%weight = p%weight(from:from + n - 1)
            c%normal = p%normal(:ndim, from:from + n - 1)
            c%xi = p%xi(:, from:from + n - 1)
            c%status = merge(0, -1, c%facet > 0)
            c%pressure = 0.0_wp
            c%force = 0.0_wp
            c%shear = 0.0_wp
            c%couple = 0.0_wp
            do i = 1, n
               motion = relative_motion(scene, model, from + i - 1, since_projection=.false.)
               c%u_n(i) = dot_product(motion(:ndim), c%normal(:, i))
               c%u_t(:, i) = motion(:ndim) - c%u_n(i)*c%normal(:, i)
               c%gap(i) = gap_of(scene, model, from + i - 1)
               ! Rows of mid-side nodes have gaps of the transformed basis.
               if (has_samples(p, from + i - 1)) c%gap(i) = c%gap(i) &
                  & + (1.0_wp - scene%interference)*scene%initial%overclosure(from + i - 1)
               if (c%status(i) < 0) c%gap(i) = 0.0_wp
            end do
            do row = scene%rows%nnormal + 1, scene%rows%n
               point = scene%rows%point(row) - from + 1
               if (point < 1 .or. point > n) cycle
               call add_row(c, scene, model, pair, row)
               if (scene%rows%tied(row)) c%status(point) = 3
            end do
            across = 0.0_wp
            do row = scene%rows%group_first(pair), scene%rows%group_first(pair + 1) - 1
               point = scene%rows%point(row) - from + 1
               across(scene%rows%point(row)) = scene%answer%force(row)
               call add_row(c, scene, model, pair, row)
               if (scene%rows%tied(row)) then
                  c%status(point) = 3
               else
                  if (.not. has_samples(p, scene%rows%point(row))) c%gap(point) = &
                     & scene%answer%gap(row) &
                     & + model%interaction(model%pair(pair)%interaction)%clearance
                  ! A law has no set of closed points: it presses or it does not.
                  if (scene%answer%force(row) > 0.0_wp .or. (scene%answer%active(row) &
                     & .and. .not. has_law(model, pair))) c%status(point) = 2
                  if (scene%rows%tangent(row) > 0) c%status(point) &
                     & = scene%trial%friction%status(scene%rows%point(row))
               end if
            end do
            c%slip_path = scene%trial%friction%path(from:from + n - 1)
            c%friction_work = scene%trial%friction%work(from:from + n - 1)
            do i = 1, n
               c%pressure(i) = dot_product(c%force(:, i), c%normal(:, i))/c%weight(i)
               if (has_samples(p, from + i - 1) .and. c%status(i) < 3) &
                  & c%pressure(i) = across(from + i - 1)/c%weight(i)
               if (c%status(i) == 3) c%shear(:, i) = c%force(:, i) &
                  & - dot_product(c%force(:, i), c%normal(:, i))*c%normal(:, i)
            end do
            frame%closed = frame%closed + count(c%status > 0)
         end associate
      end do
   end subroutine contact_values

   !> What a row adds to the forces of its point.
   subroutine add_row(field, scene, model, pair, row)
      type(contact_field_type), intent(inout) :: field
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair, row
      real(wp) :: along(size(field%force, 1)), force(3), couple(3)
      integer :: i, reference

      i = scene%rows%point(row) - scene%points%first(pair) + 1
      along = scene%answer%force(row)*scene%rows%direction(:size(along), row)
      field%force(:, i) = field%force(:, i) + along
      if (row > scene%rows%nnormal) field%shear(:, i) = field%shear(:, i) + along
      if (.not. has_samples(scene%points, scene%rows%point(row))) return
      if (scene%points%tool(pair) == 0) return
      reference = 0
      if (scene%points%body(pair) > 0) reference &
         & = model%rigid_body(scene%points%body(pair))%reference
      ! Places beside the node; only rows against tools have them.
      associate (of => scene%rows%dof(scene%rows%first(row):scene%rows%first(row + 1) - 1), &
         & share => scene%rows%coefficient(scene%rows%first(row):scene%rows%first(row + 1) - 1))
         call sum_places(model%mesh%x, scene%dofs%node(of), scene%dofs%dof(of), &
            & share*scene%answer%force(row), field%node(i), reference, force, couple)
      end associate
      field%couple(:, i) = field%couple(:, i) + couple
   end subroutine add_row
end module lopin_frames
