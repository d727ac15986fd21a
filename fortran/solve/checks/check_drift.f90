!> Bodies that move away as a whole: a forgotten support does not make the equations singular while
!> contact pushes or friction carries.
!>
!> In an increment in which a body moves by one of its floating motions, all but rigidly, it drifts
!> if no force acts on it, and is carried if only contact and friction hold it. What ends against
!> something, or is deformed, does neither any more.
module lopin_check_drift
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_model, only : model_type, surface_of
   use lopin_bodies, only : bodies_type
   use lopin_report, only : contact_field_type
   use lopin_body_words, only : describe_motion
   use lopin_contact_points, only : pair_is_tied
   use lopin_constraints, only : raw_displacement
   use lopin_scene, only : scene_type
   use lopin_repeated_messages, only : warn_once
   implicit none
   private
   public :: drift_type, measure_drift, check_drift

   !> Deformation beside motion below which a body moves as a whole.
   real(wp), parameter :: rigid = 1.0e-2_wp
   !> The same of a body under forces, which deform it a little.
   real(wp), parameter :: stiff = 0.1_wp
   !> Motions below this share of the largest of an increment say nothing of it.
   real(wp), parameter :: still = 1.0e-3_wp
   !> Ways of carried bodies beside their lengths that are told.
   real(wp), parameter :: far = 1.0e-2_wp
   !> Pressure against the motion, beside all forces of contact along it, that stops a body.
   real(wp), parameter :: opposed = 0.05_wp
   !> Forces beside stiffness times motion that are rounding.
   real(wp), parameter :: no_force = 1.0e-9_wp
   !> Amplitudes of motions that are rounding.
   real(wp), parameter :: rounding = 1.0e-9_wp
   !> Ways below this share of the bodies are how they come to rest.
   real(wp), parameter :: at_rest = 1.0e-6_wp

   !> The floating motions of a body, made orthonormal once a step.
   type :: fit_type
      integer, allocatable :: own(:)       !! equations of the body
      real(wp), allocatable :: basis(:, :)    !! (size(own), nq); 0: follows from those before it
      real(wp), allocatable :: way(:, :)   !! (nq, nq) amplitudes of each
   end type fit_type

   type :: drift_type
      real(wp), allocatable :: way(:)      !! (nbody) moved since a force last acted on it [length]
      real(wp), allocatable :: carried(:)  !! (nbody) moved since it last rested or was deformed
      real(wp), allocatable :: path(:, :)  !! (nq, nbody) that motion
      integer :: step = 0, neq = 0         !! to which the fits belong, and its equations
      type(fit_type), allocatable :: fit(:)   !! (nbody)
   end type drift_type

contains

   !> Look at the trial state of an increment that is about to be accepted.
   subroutine measure_drift(self, scene, model, load, pressed)
      type(drift_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: load(:), pressed(:)   !! (ndof) loads and contact forces [force]
      real(wp), allocatable :: q(:), change(:), force(:), most(:)
      real(wp) :: moved, strayed, largest
      logical :: glued(scene%bodies%nbody)
      integer :: b

      if (.not. allocated(self%way)) allocate (self%way(scene%bodies%nbody), &
         & self%carried(scene%bodies%nbody), source=0.0_wp)
      if (scene%bodies%nq == 0) then
         self%way = 0.0_wp
         self%carried = 0.0_wp
         return
      end if
      if (allocated(self%path)) then
         if (size(self%path, 1) /= scene%bodies%nq) deallocate (self%path)
      end if
      if (.not. allocated(self%path)) then
         allocate (self%path(scene%bodies%nq, scene%bodies%nbody), source=0.0_wp)
         self%carried = 0.0_wp
      end if
      change = scene%trial%motion%u - scene%accepted%motion%u
      largest = maxval(abs(change))
      call find_glued(scene, model, glued)
      call note_forces(scene, load, pressed, force, most)
      if (self%step /= scene%step .or. self%neq /= scene%constraints%neq) &
         & call new_fits(self, scene)
      do b = 1, scene%bodies%nbody
         if (glued(b) .or. .not. floats(scene%bodies, b)) then
            self%way(b) = 0.0_wp
            self%carried(b) = 0.0_wp
            cycle
         end if
         call fit_motion(self%fit(b), scene, change, q, moved, strayed)
         if (force(b) > no_force*most(b)*max(moved, self%way(b))) then
            self%way(b) = 0.0_wp
            call carry(self%carried(b), self%path(:, b), q, moved, strayed, largest)
         else if (strayed <= rigid*moved) then
            self%way(b) = self%way(b) + moved
         end if
      end do
   end subroutine measure_drift

   !> The largest load or contact force on each body, and its largest stiffness.
   pure subroutine note_forces(scene, load, pressed, force, most)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: load(:), pressed(:)   !! (ndof) [force]
      real(wp), allocatable, intent(out) :: force(:), most(:)   !! (nbody)
      integer :: i

      allocate (force(scene%bodies%nbody), most(scene%bodies%nbody), source=0.0_wp)
      do i = 1, scene%dofs%n
         associate (b => scene%bodies%body(scene%dofs%node(i)))
            if (b == 0) cycle
            force(b) = max(force(b), abs(load(i)), abs(pressed(i)))
            most(b) = max(most(b), scene%stiffness(i))
         end associate
      end do
   end subroutine note_forces

   !> Whether some floating motion moves a body.
   pure logical function floats(bodies, body)
      type(bodies_type), intent(in) :: bodies
      integer, intent(in) :: body

      floats = any(abs(bodies%amplitude(bodies%nmode*(body - 1) + 1:bodies%nmode*body, :)) &
         & > rounding)
   end function floats

   !> The way of a body on which forces act.
   pure subroutine carry(way, path, q, moved, strayed, largest)
      real(wp), intent(inout) :: way, path(:)
      real(wp), intent(in) :: q(:), moved, strayed, largest   !! of the increment [length]

      if (moved <= still*largest) return
      if (strayed <= stiff*moved) then
         way = way + moved
         path = path + q
      else
         way = 0.0_wp
         path = 0.0_wp
      end if
   end subroutine carry

   !> Bodies that a tie carries: they move with what they are tied to.
   subroutine find_glued(scene, model, glued)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      logical, intent(out) :: glued(:)         !! (nbody)
      integer :: i, k

      glued = .false.
      do i = 1, scene%points%n
         if (scene%points%facet(i) == 0) cycle
         if (.not. pair_is_tied(model, model%pair(scene%points%pair(i)))) cycle
         call take(scene%points%node(i))
         do k = 1, size(scene%points%master, 1)
            if (scene%points%master(k, i) > 0) call take(scene%points%master(k, i))
         end do
      end do

   contains

      subroutine take(node)
         integer, intent(in) :: node
         if (scene%bodies%body(node) > 0) glued(scene%bodies%body(node)) = .true.
      end subroutine take
   end subroutine find_glued

   !> Say at the end of the run which bodies nothing has stopped.
   subroutine check_drift(self, scene, model, contact)
      type(drift_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(contact_field_type), intent(in) :: contact(:)   !! by pair, at the end
      type(fit_type) :: fit
      real(wp), allocatable :: q(:)
      character(len=:), allocatable :: why, help
      real(wp) :: moved, strayed, way, away
      integer :: b
      logical :: drifts

      if (.not. allocated(self%way)) return
      do b = 1, size(self%way)
         ! What has come back, as a ring that was turned all the way, is not away.
         away = distance_of(scene, b)
         drifts = min(self%way(b), away) > at_rest*scene%bodies%length
         if (.not. drifts .and. min(self%carried(b), away) <= far*scene%bodies%length) cycle
         if (drifts) then
            call new_fit(fit, scene, b)
            call fit_motion(fit, scene, scene%trial%motion%u, q, moved, strayed)
            if (.not. moved > 0.0_wp) cycle
            way = self%way(b)
            why = 'no force acts on it'
            help = 'look for a support or a contact pair that is forgotten: *BOUNDARY holds '// &
               & 'the body, or something that it ends against'
         else
            q = self%path(:, b)
            if (ends_against(scene%bodies, model, contact, b, q)) cycle
            way = self%carried(b)
            why = 'nothing but contact and friction holds it'
            help = 'look for a wall or a support that is forgotten; if the body is meant to '// &
               & 'travel, nothing is wrong'
         end if
         way = min(way, away)
         call warn_once(scene%log, 'W0515', describe_motion(scene%bodies, model, q)// &
            & ': it has moved away as a whole by '//to_text(way, 4)//' at the end of '// &
            & 'step '//to_text(scene%step)//', and '//why, model%step(scene%step)%at, help=help)
      end do
   end subroutine check_drift

   !> How far the node of a body that is farthest from where it was at first is from there.
   pure real(wp) function distance_of(scene, body) result(away)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: body
      real(wp) :: square(size(scene%bodies%body))
      integer :: i

      square = 0.0_wp
      do i = 1, scene%dofs%n
         associate (node => scene%dofs%node(i))
            if (scene%bodies%body(node) /= body .or. scene%dofs%dof(i) > 3) cycle
            square(node) = square(node) + scene%trial%motion%u(i)**2
         end associate
      end do
      away = sqrt(maxval(square))
   end function distance_of

   !> Whether contact presses against the motion of a body: what it ends against.
   pure logical function ends_against(bodies, model, contact, body, q) result(stands)
      type(bodies_type), intent(in) :: bodies
      type(model_type), intent(in) :: model
      type(contact_field_type), intent(in) :: contact(:)
      integer, intent(in) :: body
      real(wp), intent(in) :: q(:)             !! (nq) the motion
      real(wp) :: way(3), against, all, pressed
      integer :: i, k, d, side

      d = model%mesh%ndim
      against = 0.0_wp
      all = 0.0_wp
      do k = 1, size(contact)
         do i = 1, size(contact(k)%node)
            side = side_of(bodies, model, k, contact(k)%node(i), body)
            if (side == 0) cycle
            way = side*motion_at(bodies, model, body, q, contact(k)%node(i))
            associate (f => contact(k)%force(:d, i), n => contact(k)%normal(:d, i))
               pressed = dot_product(f, n)*dot_product(n, way(:d))
               against = against + max(-pressed, 0.0_wp)
               all = all + abs(pressed) + abs(dot_product(f, way(:d)) - pressed)
            end associate
         end do
      end do
      stands = against > opposed*all
   end function ends_against

   !> 1: the body is the slave of a point; -1: its master; 0: neither, or both.
   pure integer function side_of(bodies, model, pair, node, body) result(side)
      type(bodies_type), intent(in) :: bodies
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair, node, body

      side = 0
      if (bodies%body(node) == body) side = 1
      associate (master => model%surface(model%pair(pair)%master))
         if (master%kind /= surface_of%faces .or. size(master%element) == 0) return
         if (bodies%body(model%mesh%conn(1, master%element(1))) == body) side = side - 1
      end associate
   end function side_of

   !> How a rigid motion of a body moves the place of a node.
   pure function motion_at(bodies, model, body, q, node) result(way)
      type(bodies_type), intent(in) :: bodies
      type(model_type), intent(in) :: model
      integer, intent(in) :: body, node
      real(wp), intent(in) :: q(:)             !! (nq)
      real(wp) :: way(3), turn(3), arm(3), a(bodies%nmode)

      a = matmul(bodies%amplitude(bodies%nmode*(body - 1) + 1:bodies%nmode*body, :), q)
      way = 0.0_wp
      turn = 0.0_wp
      select case (bodies%nmode)
      case (1)
         way(2) = a(1)
      case (3)
         way(:2) = a(:2)
         turn(3) = a(3)
      case default
         way = a(:3)
         turn = a(4:6)
      end select
      arm = 0.0_wp
      arm(:model%mesh%ndim) = model%mesh%x(:, node)
      arm = (arm - bodies%centre(:, body))/bodies%length
      way = way + [turn(2)*arm(3) - turn(3)*arm(2), turn(3)*arm(1) - turn(1)*arm(3), &
         & turn(1)*arm(2) - turn(2)*arm(1)]
   end function motion_at

   !> The floating motions of all bodies in this step: they follow from its supports.
   subroutine new_fits(self, scene)
      type(drift_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      integer :: b

      if (allocated(self%fit)) deallocate (self%fit)
      allocate (self%fit(scene%bodies%nbody))
      do b = 1, size(self%fit)
         if (floats(scene%bodies, b)) call new_fit(self%fit(b), scene, b)
      end do
      self%step = scene%step
      self%neq = scene%constraints%neq
   end subroutine new_fits

   !> Gram and Schmidt on the floating motions of a body; motions of other bodies vanish here.
   subroutine new_fit(self, scene, body)
      type(fit_type), intent(out) :: self
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: body
      real(wp) :: share, before
      integer :: i, k, m, n

      self%own = pack([(i, i=1, scene%constraints%neq)], &
         & scene%bodies%body(scene%dofs%node(scene%constraints%dof_of_equation)) == body)
      self%basis = scene%bodies%motion(self%own, :)
      n = scene%bodies%nq
      allocate (self%way(n, n), source=0.0_wp)
      associate (basis => self%basis, way => self%way)
         do k = 1, n
            way(k, k) = 1.0_wp
            before = norm2(basis(:, k))
            do m = 1, k - 1
               share = dot_product(basis(:, m), basis(:, k))
               basis(:, k) = basis(:, k) - share*basis(:, m)
               way(:, k) = way(:, k) - share*way(:, m)
            end do
            if (.not. norm2(basis(:, k)) > 1.0e-6_wp*max(before, 1.0_wp)) then
               basis(:, k) = 0.0_wp
               way(:, k) = 0.0_wp
               cycle
            end if
            way(:, k) = way(:, k)/norm2(basis(:, k))
            basis(:, k) = basis(:, k)/norm2(basis(:, k))
         end do
      end associate
   end subroutine new_fit

   !> The floating motion nearest to displacements of a body, and what is left of them.
   subroutine fit_motion(self, scene, u, q, moved, strayed)
      type(fit_type), intent(in) :: self          !! of the body
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: u(:)                !! (ndof) [length]
      real(wp), allocatable, intent(out) :: q(:)  !! (nq) amplitudes
      real(wp), intent(out) :: moved, strayed     !! largest components [length]
      real(wp) :: left(size(self%own)), whole(size(self%own)), share
      integer :: i, k

      associate (c => scene%constraints)
         do i = 1, size(left)
            left(i) = raw_displacement(c, scene%dofs, u, c%dof_of_equation(self%own(i)))
         end do
      end associate
      allocate (q(size(self%way, 1)), source=0.0_wp)
      whole = 0.0_wp
      do k = 1, size(q)
         share = dot_product(self%basis(:, k), left)
         q = q + share*self%way(:, k)
         whole = whole + share*self%basis(:, k)
      end do
      moved = 0.0_wp
      strayed = 0.0_wp
      do i = 1, size(left)
         moved = max(moved, abs(whole(i)))
         strayed = max(strayed, abs(left(i) - whole(i)))
      end do
   end subroutine fit_motion
end module lopin_check_drift
