!> Work of the artificial springs that hold floating bodies.
!>
!> A body that floats has no equilibrium that tells where it goes: artificial supports of the linear
!> path keep it where it was, soft springs of Newton's iterations lead it to where contact holds it.
!> What loads do on such a way, ½ |F0 + F1| R dq by the rule of the external work, is stored
!> nowhere: these holds take it up, at most what the energies of the increment miss. Where friction
!> holds the body in the end, they may have pulled it over the bound of friction: what the slip
!> would have taken, and did not, is theirs too.
module lopin_artificial_work
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_stream, only : stream_type
   use lopin_model, only : model_type
   use lopin_dense, only : symmetric_eigen
   use lopin_constraints, only : reduce, raw_displacement
   use lopin_body_words, only : describe_motion
   use lopin_report, only : energy_type, lost_work
   use lopin_certificate, only : artificial_limit
   use lopin_slip_increment, only : dissipated, path_of, shear_bound
   use lopin_contact_row, only : contact_status
   use lopin_predictor, only : resistance
   use lopin_vectors, only : largest
   use lopin_scene, only : scene_type
   use lopin_repeated_messages, only : warn_once, note_once
   use lopin_contact_rows, only : joins_pair
   implicit none
   private
   public :: artificial_type, measure_artificial_work, check_artificial_work

   !> Forces beside the largest that are none.
   real(wp), parameter :: no_force = 1.0e-9_wp
   !> Motions that contact resists by less than this, beside the one it resists most, float.
   real(wp), parameter :: resisted = 1.0e-10_wp

   !> Motions that contact resists by less than this are held by friction, if by anything: slopes of
   !> a tenth are.
   real(wp), parameter :: hardly = 1.0e-2_wp

   type :: artificial_type
      real(wp) :: work = 0.0_wp                 !! so far [energy]
      real(wp) :: lost = 0.0_wp                 !! of the energies before the increment [energy]
      real(wp) :: most = 0.0_wp                 !! of one increment [energy]
      integer :: at(2) = 0                      !! its step and number
      real(wp), allocatable :: pressed(:)       !! (ndof) contact forces before it [force]
   contains
      procedure :: keep
   end type artificial_type

contains

   !> To a stream or back.
   subroutine keep(self, stream)
      class(artificial_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%work)
      call stream%pass(self%lost)
      call stream%pass(self%most)
      call stream%pass_within(self%at)
      call stream%pass(self%pressed)
   end subroutine keep

   !> Add the artificial work of an increment that is about to be accepted; its other energies are
   !> known.
   subroutine measure_artificial_work(self, scene, model, pressed, increment, energy)
      type(artificial_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: pressed(:)       !! (ndof) contact forces [force]
      integer, intent(in) :: increment         !! number
      type(energy_type), intent(inout) :: energy
      real(wp) :: before(scene%constraints%neq), now(scene%constraints%neq), work

      if (scene%bodies%nq > 0) then
         before = 0.0_wp
         if (allocated(self%pressed)) call reduce(scene%constraints, self%pressed, before)
         call reduce(scene%constraints, pressed, now)
         work = min(work_of_loads(scene, model, before, now), &
            & max(0.0_wp, lost_work(energy) - self%lost)) + work_against_friction(scene) &
            & + work_of_sliding(scene)
         self%work = self%work + work
         if (work > self%most) then
            self%most = work
            self%at = [scene%step, increment]
         end if
         call report_rest(scene, model)
      end if
      self%pressed = pressed
      energy%artificial = self%work
   end subroutine measure_artificial_work

   !> What loads do on the ways of bodies that no contact holds at one end of the increment, or that
   !> soft springs have led; what contact pushes the same way at both ends is its own work.
   real(wp) function work_of_loads(scene, model, before, now) result(work)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: before(:), now(:)   !! (neq) contact forces [force]
      real(wp) :: moved(scene%constraints%neq)
      real(wp), allocatable :: force(:, :), power(:, :)
      real(wp) :: least, all_motions(scene%bodies%nq, scene%bodies%nq)
      integer :: body(scene%constraints%neq), i, b

      work = 0.0_wp
      allocate (force(2, scene%bodies%nbody + size(model%rigid_body)), source=0.0_wp)
      do i = 1, size(body)
         ! Contact pushes few equations.
         if (before(i) == 0.0_wp .and. now(i) == 0.0_wp) cycle
         b = body_of_equation(scene, model, i)
         if (b > 0) force(:, b) = max(force(:, b), abs([before(i), now(i)]))
      end do
      if (scene%newton%in_use .and. scene%newton%grounded == 0) return
      least = no_force*maxval(force)
      if (scene%newton%grounded == 0 .and. .not. any(minval(force, dim=1) <= least &
         & .and. maxval(force, dim=1) > least)) return
      do b = 1, scene%bodies%nq
         all_motions(:, b) = 0.0_wp
         all_motions(b, b) = 1.0_wp
      end do
      call rigid_part(scene, all_motions, moved)
      do i = 1, size(body)
         body(i) = body_of_equation(scene, model, i)
      end do
      allocate (power, source=0.0_wp*force)
      do i = 1, size(body)
         if (body(i) > 0) power(:, body(i)) = power(:, body(i)) + [before(i), now(i)]*moved(i)
      end do
      do b = 1, size(force, 2)
         if (scene%newton%grounded == 0 .and. minval(force(:, b)) > least) cycle
         if (product(power(:, b)) <= 0.0_wp) work = work + 0.5_wp*abs(sum(power(:, b))) &
            & *share_of_fall(scene, moved, body, b)
      end do
   end function work_of_loads

   !> How much of the way of a body on the linear path lies before its first contact, or after its
   !> last: the rest is work that contact does.
   real(wp) function share_of_fall(scene, moved, body, b) result(share)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: moved(:)         !! (neq) [length]
      integer, intent(in) :: body(:)           !! (neq)
      integer, intent(in) :: b
      real(wp) :: gap, way, nearest
      integer :: row, k, equation(scene%dofs%n)
      logical :: own

      share = 1.0_wp
      if (scene%newton%in_use) return
      equation = 0
      equation(scene%constraints%dof_of_equation) = body
      way = huge(1.0_wp)
      nearest = huge(1.0_wp)
      do row = 1, scene%rows%n
         if (.not. joins_pair(scene%rows, row)) cycle
         own = .false.
         gap = scene%rows%gap0(row)
         do k = scene%rows%first(row), scene%rows%first(row + 1) - 1
            own = own .or. equation(scene%rows%dof(k)) == b
            gap = gap + scene%rows%coefficient(k)*scene%accepted%motion%u(scene%rows%dof(k))
         end do
         if (.not. own) cycle
         ! What has closed has come from that far; what has opened stands apart now.
         if (abs(scene%answer%force(row)) > 0.0_wp) way = min(way, gap)
         nearest = min(nearest, scene%answer%gap(row))
      end do
      if (.not. way < huge(1.0_wp)) way = nearest
      if (way < huge(1.0_wp)) share = min(1.0_wp, max(way, 0.0_wp) &
         & /max(maxval(abs(moved), mask=body == b), tiny(1.0_wp)))
   end function share_of_fall

   !> What slip of the increment would have taken beyond the work that friction has done, where soft
   !> springs have led a body.
   pure real(wp) function work_against_friction(scene) result(work)
      type(scene_type), intent(in) :: scene
      real(wp) :: bound
      integer :: i

      work = 0.0_wp
      if (.not. scene%newton%in_use .or. scene%newton%grounded == 0) return
      associate (c => scene%newton%contact)
         do i = 1, c%n
            if (c%facet(i) == 0 .or. c%status(i) == 0 .or. c%enforcement(i)%tied) cycle
            bound = shear_bound(c, i)
            if (.not. bound < huge(1.0_wp)) cycle
            work = work + max(0.0_wp, bound*path_of(c, i) - dissipated(c, i))*c%weight(i)
         end do
      end associate
   end function work_against_friction

   !> Work of friction on motions that friction alone held, until all of it slipped: such a body is
   !> a mechanism, and how far it slides is not a matter of equilibrium.
   real(wp) function work_of_sliding(scene) result(work)
      type(scene_type), intent(in) :: scene
      real(wp) :: held(scene%bodies%nq, scene%bodies%nq), value(scene%bodies%nq)
      real(wp) :: moved(scene%constraints%neq), bound, way
      integer :: i, status

      work = 0.0_wp
      if (.not. scene%newton%in_use .or. scene%newton%grounded > 0) return
      if (.not. any(scene%newton%contact%status == contact_status%slip)) return
      if (.not. allocated(scene%newton%system%block)) return
      call resistance(scene, held)
      call symmetric_eigen(held, value, status)
      if (status /= 0) return
      i = count(value <= hardly*value(size(value)))
      if (i == 0) return
      call rigid_part(scene, held(:, :i), moved)
      way = largest(moved)
      associate (c => scene%newton%contact)
         do i = 1, c%n
            if (c%facet(i) == 0 .or. c%status(i) /= contact_status%slip) cycle
            bound = shear_bound(c, i)
            if (bound < huge(1.0_wp)) work = work + bound*min(path_of(c, i), way)*c%weight(i)
         end do
      end associate
   end function work_of_sliding

   !> Deformable body of a free equation, or rigid body behind them; 0: neither.
   pure integer function body_of_equation(scene, model, equation) result(body)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: equation
      integer :: k

      associate (node => scene%dofs%node(scene%constraints%dof_of_equation(equation)))
         body = scene%bodies%body(node)
         do k = 1, size(model%rigid_body)
            if (body > 0) exit
            if (model%rigid_body(k)%reference == node) body = scene%bodies%nbody + k
         end do
      end associate
   end function body_of_equation

   !> The part of the motion of the increment that some floating motions make.
   subroutine rigid_part(scene, motion, moved)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: motion(:, :)     !! (nq, n) in the floating motions
      real(wp), intent(out) :: moved(:)        !! (neq) [length]
      real(wp) :: way(size(moved)), basis(size(moved), size(motion, 2)), before
      integer :: i, k, m

      associate (c => scene%constraints)
         way = [(raw_displacement(c, scene%dofs, scene%trial%motion%u, c%dof_of_equation(i)) &
            & - raw_displacement(c, scene%dofs, scene%accepted%motion%u, c%dof_of_equation(i)), &
            & i=1, size(way))]
      end associate
      basis = matmul(scene%bodies%motion, motion)
      moved = 0.0_wp
      do k = 1, size(basis, 2)
         before = norm2(basis(:, k))
         do m = 1, k - 1
            basis(:, k) = basis(:, k) - dot_product(basis(:, m), basis(:, k))*basis(:, m)
         end do
         if (.not. norm2(basis(:, k)) > 1.0e-6_wp*before) then
            basis(:, k) = 0.0_wp
         else
            basis(:, k) = basis(:, k)/norm2(basis(:, k))
         end if
         moved = moved + dot_product(basis(:, k), way)*basis(:, k)
      end do
   end subroutine rigid_part

   !> Say once a step of the linear path which body stays where it is because nothing acts on it.
   subroutine report_rest(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: gram(scene%bodies%nq, scene%bodies%nq), value(scene%bodies%nq)
      integer :: i, j, status

      if (scene%newton%in_use .or. .not. allocated(scene%problem%c)) return
      if (size(scene%problem%c, 1) /= scene%rows%nsolved) return
      do i = 1, size(value)
         do j = 1, size(value)
            gram(j, i) = sum(scene%problem%c(:, j)*scene%problem%c(:, i), &
               & mask=abs(scene%answer%force(:scene%rows%nsolved)) &
               & > 0.0_wp)
         end do
      end do
      call symmetric_eigen(gram, value, status)
      if (status /= 0 .or. value(1) > resisted*maxval(sum(scene%problem%c**2, dim=1))) return
      call note_once(scene%log, 'N0511', describe_motion(scene%bodies, model, gram(:, 1))// &
         & ' in an increment of step '//to_text(scene%step)//' and no contact resists: it '// &
         & 'stays where it is, for nothing acts on it', model%step(scene%step)%at)
   end subroutine report_rest

   !> Say at the end of the run what artificial holds have done, where it is not small.
   subroutine check_artificial_work(self, scene, model, energy)
      type(artificial_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(energy_type), intent(in) :: energy      !! of the last increment

      if (.not. self%work > artificial_limit*energy%most) return
      call warn_once(scene%log, 'W0532', 'bodies that nothing held for a while, or that '// &
         & 'friction alone holds, were led by artificial means: their work is '// &
         & to_text(self%work, 3)//', '//to_text(100.0_wp*self%work/energy%most, 3)// &
         & ' % of that of the run; most of '// &
         & 'it, '//to_text(self%most, 3)//', in step '//to_text(self%at(1))//', increment '// &
         & to_text(self%at(2)), model%step(scene%step)%at, help='smaller increments; drive the '// &
         & 'body by displacement until it touches, or hold it by *BOUNDARY')
   end subroutine check_artificial_work
end module lopin_artificial_work
