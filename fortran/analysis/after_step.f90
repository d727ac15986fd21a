!> What the end of a step tells the user: pairs that never met, and motions too large for the
!> theory.
module lopin_after_step
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, log_type, severity
   use lopin_text, only : to_text
   use lopin_model, only : model_type, kind_of, method_of
   use lopin_friction, only : has_friction
   use lopin_scene, only : scene_type, relative_motion, gap_of
   use lopin_methods, only : has_law
   use lopin_tool, only : foot_type, project_moved
   use lopin_rigid_motion, only : rigid_motion_type, new_rigid_motion
   use lopin_state, only : energy_type, lost_work
   implicit none
   private
   public :: seen_type, look_at_pairs, judge_step, say_once, pair_that_slid

   !> Limits of small displacement: slip over facet, rotation [rad], strain [-].
   real(wp), parameter :: slip_limit = 0.25_wp, rotation_limit = 0.05_wp, strain_limit = 0.05_wp

   !> The elastic slip that penalty pairs choose, in facets; slips this many times it dwarf it.
   real(wp), parameter :: chosen_slip = 0.005_wp, slips = 20.0_wp
   !> Normals are parallel up to this.
   real(wp), parameter :: parallel = 1.0e-8_wp

   !> Work that may be lost, beside all of it.
   real(wp), parameter :: balance_limit = 0.01_wp

   !> What was seen of the pairs so far.
   type :: seen_type
      logical, allocatable :: closed(:)      !! (npair) at some increment
      real(wp), allocatable :: nearest(:)    !! (npair) smallest gap [length]
   end type seen_type

contains

   !> Warn, unless the same was said at the same place before.
   subroutine say_once(log, id, message, at, help)
      type(log_type), intent(inout) :: log
      character(len=*), intent(in) :: id, message
      type(location_type), intent(in) :: at
      character(len=*), intent(in), optional :: help
      integer :: i

      do i = 1, log%n
         if (log%item(i)%id == id .and. log%item(i)%at%line == at%line &
            & .and. log%item(i)%at%file == at%file) return
      end do
      call log%say(severity%warning, id, message, at, help=help)
   end subroutine say_once

   subroutine look_at_pairs(self, scene, model)
      type(seen_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer :: pair, i, row

      if (.not. allocated(self%closed)) then
         allocate (self%closed(size(model%pair)), source=.false.)
         allocate (self%nearest(size(model%pair)), source=huge(1.0_wp))
      end if
      if (scene%finite%in_use) then
         call look_at_finite(self, scene)
         return
      end if
      do row = 1, scene%rows%nnormal
         pair = scene%points%pair(scene%rows%point(row))
         self%closed(pair) = self%closed(pair) .or. scene%rows%tied(row) &
            & .or. scene%answer%force(row) > 0.0_wp &
            & .or. (scene%answer%active(row) .and. .not. has_law(model, pair))
      end do
      do i = 1, scene%points%n
         pair = scene%points%pair(i)
         if (self%closed(pair) .or. scene%points%facet(i) == 0) cycle
         self%nearest(pair) = min(self%nearest(pair), gap_of(scene, model, i))
      end do
   end subroutine look_at_pairs

   subroutine look_at_finite(self, scene)
      type(seen_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      integer :: i

      associate (c => scene%finite%contact)
         do i = 1, c%n
            if (c%facet(i) == 0) cycle
            self%closed(c%pair(i)) = self%closed(c%pair(i)) .or. c%status(i) > 0
            self%nearest(c%pair(i)) = min(self%nearest(c%pair(i)), c%gap(i))
         end do
      end associate
   end subroutine look_at_finite

   !> Say at the end of a step what its answer cannot be trusted in, and after the last what never
   !> met.
   subroutine judge_step(scene, model, seen, energy)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(seen_type), intent(in) :: seen
      type(energy_type), intent(in) :: energy      !! of the last increment
      integer :: pair

      if (scene%step == size(model%step)) then
         do pair = 1, size(model%pair)
            if (seen%closed(pair) .or. .not. seen%nearest(pair) < huge(1.0_wp)) cycle
            call say_once(scene%log, 'W0314', 'pair ('// &
               & model%surface(model%pair(pair)%slave)%name//', '// &
               & model%surface(model%pair(pair)%master)%name// &
               & ') never closed; its smallest gap was '// &
               & to_text(seen%nearest(pair), 6), model%pair(pair)%at, &
               & help='look at units and positions if it was meant to touch')
         end do
      end if
      if (.not. scene%finite%in_use) call judge_slip(scene, model)
      if (.not. scene%finite%nlgeom) call judge_elements(scene, model)
      call judge_rigid_bodies(scene, model)
      call judge_elastic_slip(scene, model)
      if (scene%finite%memory%in_use) call judge_balance(scene, model, energy)
   end subroutine judge_step

   !> Work that is neither stored nor dissipated: what the increments were too large for.
   subroutine judge_balance(scene, model, energy)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(energy_type), intent(in) :: energy
      real(wp) :: lost

      lost = lost_work(energy)
      if (.not. abs(lost) > balance_limit) return
      call say_once(scene%log, 'W0530', to_text(100.0_wp*lost, 3)// &
         & ' % of the work is neither stored nor dissipated at the end of step '// &
         & to_text(scene%step), model%step(scene%step)%at, &
         & help='smaller increments on *STATIC: they are what the energies are integrated over')
   end subroutine judge_balance

   !> The nodes of a rigid body follow its rotation linearly: on tangents, not on circles.
   subroutine judge_rigid_bodies(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: turn(3)
      integer :: body, k

      do body = 1, size(model%rigid_body)
         associate (rigid => model%rigid_body(body))
            if (size(rigid%node) == 0) cycle
            turn = 0.0_wp
            do k = 4, 6
               if (scene%dofs%id(k, rigid%reference) > 0) turn(k - 3) = &
                  & scene%u(scene%dofs%id(k, rigid%reference))
            end do
            if (norm2(turn) <= rotation_limit) cycle
            call say_once(scene%log, 'W0513', 'rigid body '//rigid%name//' turns by '// &
               & to_text(norm2(turn), 3)//' rad, and its nodes follow on tangents instead of '// &
               & 'circles: the body swells by '//to_text(100.0_wp*(sqrt(1.0_wp &
               & + norm2(turn)**2) - 1.0_wp), 3)//' %', rigid%at, &
               & help='prescribe the displacements of the nodes, or use an analytic or STL tool')
         end associate
      end do
   end subroutine judge_rigid_bodies

   !> An elastic slip that was chosen must be small beside the slips that it stands in for.
   subroutine judge_elastic_slip(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: facet
      integer :: point, pair

      if (scene%finite%in_use .or. .not. allocated(scene%friction%trial%path)) return
      do pair = 1, size(model%pair)
         associate (way => model%interaction(model%pair(pair)%interaction))
            if (way%method /= method_of%penalty .and. way%method /= method_of%perturbed) cycle
            if (.not. has_friction(way%friction) .or. way%friction%exact_stick) cycle
            if (way%friction%elastic_slip + way%friction%slip_tolerance &
               & + way%friction%stick_slope > 0.0_wp) cycle
         end associate
         facet = 0.0_wp
         do point = scene%points%first(pair), scene%points%first(pair + 1) - 1
            facet = max(facet, scene%points%size(point))
         end do
         if (scene%points%first(pair + 1) == scene%points%first(pair)) cycle
         associate (path => scene%friction%trial%path(scene%points%first(pair): &
            & scene%points%first(pair + 1) - 1))
            if (maxval(path) > slips*chosen_slip*facet) cycle
            call say_once(scene%log, 'W0514', 'no node of '// &
               & model%surface(model%pair(pair)%slave)%name//' slips farther than '// &
               & to_text(maxval(path), 3)//', and sticking ones give way by up to '// &
               & to_text(chosen_slip*facet, 3)//' (0.5 % of a facet, chosen): the zones of stick '// &
               & 'and slip are blurred', model%pair(pair)%at, &
               & help='DIRECT sticks exactly; or give ELASTIC SLIP= on *FRICTION')
         end associate
      end do
   end subroutine judge_elastic_slip

   !> Closed points that have slid far on their facet: the normal and the place are those of the
   !> start.
   subroutine judge_slip(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: largest
      integer :: worst

      call worst_slip(scene, model, [(.true., worst=1, size(model%pair))], worst, largest)
      if (worst == 0) return
      call say_once(scene%log, 'W0505', 'node '// &
         & to_text(model%mesh%node_label(scene%points%node(worst)))// &
         & ' has slid by '//to_text(nint(100.0_wp*largest))//' % of its facet in step '// &
         & to_text(scene%step)// &
         & ': contact is followed where the node was at the start', &
         & model%pair(scene%points%pair(worst))%at, &
         & help='the pressure is moved by as much: judge the answer by this distance, or '// &
         & 'take *LOPIN, PATH=FINITE, which follows the slave')
   end subroutine judge_slip

   !> The pair without SMALL SLIDING whose points slid farther than the small theory bears; 0: none.
   integer function pair_that_slid(scene, model) result(pair)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: largest
      integer :: worst

      call worst_slip(scene, model, .not. model%pair%small_sliding, worst, largest, turning=.true.)
      pair = 0
      if (worst > 0) pair = scene%points%pair(worst)
   end function pair_that_slid

   !> The tool's normal where the point is now is not that where it was projected: along a plane
   !> sliding changes nothing.
   logical function turns(scene, model, point)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: point
      type(rigid_motion_type) :: motion
      type(foot_type) :: foot
      real(wp) :: x(model%mesh%ndim), own(3), at(model%mesh%ndim), place(6)
      integer :: body, d

      turns = .true.
      d = model%mesh%ndim
      associate (pair => scene%points%pair(point))
         if (scene%points%tool(pair) == 0) return
         own = own_motion(scene, model, scene%points%node(point))
         x = model%mesh%x(:, scene%points%node(point)) + own(:d)
         body = scene%points%body(pair)
         place = 0.0_wp
         at = 0.0_wp
         if (body > 0) then
            place = scene%place(:, body)
            at = model%mesh%x(:, model%rigid_body(body)%reference)
         end if
         if (d == 2) call new_rigid_motion(motion, at, place(:2), place(6:6))
         if (d == 3) call new_rigid_motion(motion, at, place(:3), place(4:6))
         call project_moved(model%tool(scene%points%tool(pair))%shape, motion, x, foot)
         turns = dot_product(foot%normal(:d), scene%points%normal(:d, point)) < 1.0_wp - parallel
      end associate
   end function turns

   !> The closed point of the asked pairs that slid farthest beyond the limit; 0: none did.
   subroutine worst_slip(scene, model, asked, worst, largest, turning)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      logical, intent(in) :: asked(:)          !! (npair)
      integer, intent(out) :: worst
      real(wp), intent(out) :: largest         !! slip over facet
      logical, intent(in), optional :: turning !! only where the normal has changed
      real(wp) :: motion(3), slip
      integer :: row, point

      largest = slip_limit
      worst = 0
      do row = 1, scene%rows%nnormal
         if (scene%rows%tied(row) .or. .not. scene%answer%force(row) > 0.0_wp) cycle
         point = scene%rows%point(row)
         if (.not. asked(scene%points%pair(point))) cycle
         ! What a tool does itself is projected where it stands: there only the slave's own way
         ! counts.
         if (scene%points%tool(scene%points%pair(point)) > 0) then
            motion = own_motion(scene, model, scene%points%node(point))
         else
            motion = relative_motion(scene, model, point, since_projection=.false.)
         end if
         motion = motion &
            & - dot_product(motion, scene%points%normal(:, point))*scene%points%normal(:, point)
         slip = norm2(motion)/scene%points%size(point)
         if (slip <= largest) cycle
         if (present(turning)) then
            if (.not. turns(scene, model, point)) cycle
         end if
         largest = slip
         worst = point
      end do
   end subroutine worst_slip

   function own_motion(scene, model, node) result(motion)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: node
      real(wp) :: motion(3)
      integer :: k

      motion = 0.0_wp
      do k = 1, model%mesh%ndim
         if (scene%dofs%id(k, node) > 0) motion(k) = scene%u(scene%dofs%id(k, node))
      end do
   end function own_motion

   !> Rotations and strains of the elements, from the mean gradient of their nodes' displacements.
   subroutine judge_elements(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: rotation, strain, most_rotation, most_strain
      integer :: e, turned, strained

      most_rotation = rotation_limit
      most_strain = strain_limit
      turned = 0
      strained = 0
      do e = 1, model%mesh%nelement
         if (model%mesh%section(e) == 0) cycle
         call mean_gradient(scene, model, e, rotation, strain)
         if (rotation > most_rotation) then
            most_rotation = rotation
            turned = e
         end if
         if (strain > most_strain) then
            most_strain = strain
            strained = e
         end if
      end do
      if (turned > 0) call say_once(scene%log, 'W0506', 'element '// &
         & to_text(model%mesh%element_label(turned))// &
         & ' turns by '//to_text(most_rotation, 3)// &
         & ' rad: rotations are taken as small (NLGEOM=NO)', &
         & model%step(scene%step)%at, &
         & help='a rotation t stretches by t^2/2; hold the motion if it is not meant')
      if (strained > 0) call say_once(scene%log, 'W0507', 'element '// &
         & to_text(model%mesh%element_label(strained))// &
         & ' is strained by '//to_text(100.0_wp*most_strain, 3)// &
         & ' %: strains are taken as small (NLGEOM=NO)', &
         & model%step(scene%step)%at, &
         & help='look at units, loads and modulus; beyond 5 % the answer is linear in name only')
   end subroutine judge_elements

   !> Least squares: H = sum (u - u_mean)(x - x_mean)^T [sum (x - x_mean)(x - x_mean)^T]^-1.
   subroutine mean_gradient(scene, model, e, rotation, strain)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: e
      real(wp), intent(out) :: rotation            !! [rad]
      real(wp), intent(out) :: strain              !! largest component, shears halved [-]
      real(wp) :: x(3, 20), u(3, 20), moment(3, 3), h(3, 3), middle(3), mean(3)
      integer :: n, k, d

      d = model%mesh%ndim
      n = 0
      x = 0.0_wp
      do k = 1, size(model%mesh%conn, 1)
         if (model%mesh%conn(k, e) == 0) exit
         n = n + 1
         x(:d, n) = model%mesh%x(:, model%mesh%conn(k, e))
         u(:, n) = own_motion(scene, model, model%mesh%conn(k, e))
      end do
      middle = sum(x(:, :n), dim=2)/n
      mean = sum(u(:, :n), dim=2)/n
      moment = 0.0_wp
      h = 0.0_wp
      do k = 1, n
         moment = moment + outer(x(:, k) - middle, x(:, k) - middle)
         h = h + outer(u(:, k) - mean, x(:, k) - middle)
      end do
      if (d == 2) moment(3, 3) = moment(1, 1) + moment(2, 2)
      h = matmul(h, inverse(moment))
      rotation = 0.5_wp*norm2([h(3, 2) - h(2, 3), h(1, 3) - h(3, 1), h(2, 1) - h(1, 2)])
      strain = maxval(abs(0.5_wp*(h + transpose(h))))
      if (model%kind == kind_of%axisymmetric .and. middle(1) > 0.0_wp) strain = max(strain, &
         & abs(mean(1))/middle(1))
   end subroutine mean_gradient

   pure function outer(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3, 3)
      integer :: j
      do j = 1, 3
         c(:, j) = a*b(j)
      end do
   end function outer

   pure function inverse(a) result(b)
      real(wp), intent(in) :: a(3, 3)
      real(wp) :: b(3, 3)
      integer :: i, j, p, q, r, s

      do j = 1, 3
         do i = 1, 3
            p = mod(j, 3) + 1
            q = mod(j + 1, 3) + 1
            r = mod(i, 3) + 1
            s = mod(i + 1, 3) + 1
            b(i, j) = a(p, r)*a(q, s) - a(p, s)*a(q, r)
         end do
      end do
      b = b/dot_product(a(1, :), b(:, 1))
   end function inverse
end module lopin_after_step
