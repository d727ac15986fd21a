!> Advice: what a deck models beyond what its scene needs, and what leaving it out would save.
!>
!> Notes only, on what can be told from the deck alone: the answer of such a deck is right.
module lopin_advise
   use lopin_kinds, only : wp
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_model, only : model_type, kind_of, surface_of
   use lopin_friction, only : has_friction
   use lopin_advise_slaves, only : advise_slaves
   use lopin_advise_tools, only : advise_tools
   use lopin_advise_symmetry, only : advise_symmetry
   use lopin_advise_revolution, only : advise_revolution
   implicit none
   private
   public :: advise

   !> A master so many times as stiff as its slave gives way by less than a hundredth of the whole.
   real(wp), parameter :: all_but_rigid = 100.0_wp
   !> Decks of fewer elements are done before their advice is read.
   integer, parameter :: worth_saying = 200

contains

   subroutine advise(model)
      type(model_type), intent(inout) :: model
      integer :: plane
      logical :: told

      if (model%remeshes .or. size(model%step) == 0) return
      call advise_plane(model, plane)
      call advise_rigid(model)
      call advise_increments(model)
      call advise_tools(model)
      if (model%mesh%nelement < worth_saying) return
      call advise_slaves(model)
      call advise_revolution(model, told)
      if (.not. told) call advise_symmetry(model, plane)
   end subroutine advise

   !> A mesh in space all of whose nodes are held in one direction is in plane strain.
   subroutine advise_plane(model, direction)
      type(model_type), intent(inout) :: model
      integer, intent(out) :: direction        !! that one; 0: none
      logical :: used(model%mesh%nnode), held(3, model%mesh%nnode)
      integer :: e, i, s, k

      direction = 0
      if (model%kind /= kind_of%solid .or. model%mesh%nelement < worth_saying) return
      ! Dofs of turned axes are not those of the mesh.
      if (allocated(model%transform%node)) then
         if (size(model%transform%node) > 0) return
      end if
      used = .false.
      do e = 1, model%mesh%nelement
         if (model%mesh%section(e) == 0) cycle
         associate (node => pack(model%mesh%conn(:, e), model%mesh%conn(:, e) > 0))
            used(node) = .true.
         end associate
      end do
      held = .true.
      do s = 1, size(model%step)
         block
            logical :: now(3, model%mesh%nnode)

            now = .false.
            do i = 1, size(model%step(s)%prescribed)
               associate (p => model%step(s)%prescribed(i))
                  if (p%dof <= 3 .and. .not. abs(p%value) > 0.0_wp) now(p%dof, p%node) = .true.
               end associate
            end do
            held = held .and. now
         end block
      end do
      do k = 1, 3
         if (.not. all(held(k, :) .or. .not. used)) cycle
         direction = k
         call model%log%say(severity%note, 'N0361', 'every node is held in direction '// &
            & to_text(k)//': the scene is one of plane strain, meshed in space', &
            & model%step(1)%at, help='a plane mesh (CPE4, CPE8) has the same answer with half '// &
            & 'the nodes or fewer, and two equations at each instead of three')
         return
      end do
   end subroutine advise_plane

   !> A meshed master that is far stiffer than its slave could be rigid.
   subroutine advise_rigid(model)
      type(model_type), intent(inout) :: model
      real(wp) :: slave, master
      integer :: p, n

      do p = 1, size(model%pair)
         associate (pair => model%pair(p))
            if (pair%tied .or. pair%master == 0 .or. pair%slave == pair%master) cycle
            if (model%surface(pair%master)%kind /= surface_of%faces) cycle
            call stiffness_of(model, pair%slave, slave, n)
            call stiffness_of(model, pair%master, master, n)
            if (.not. slave > 0.0_wp .or. master < all_but_rigid*slave .or. n < worth_saying) cycle
            call model%log%say(severity%note, 'N0362', 'master '// &
               & model%surface(pair%master)%name//' is '//to_text(master/slave, 2)// &
               & ' times as stiff as '//model%surface(pair%slave)%name//': it is all but rigid', &
               & pair%at, help='as a *RIGID BODY it takes no equations ('//to_text(n)// &
               & ' of '//to_text(count(model%mesh%section > 0))//' elements are of its '// &
               & 'material), and the approach changes by about '// &
               & to_text(100.0_wp*slave/master, 1)//' %')
         end associate
      end do
   end subroutine advise_rigid

   !> Modulus of the elements behind a surface, 0 if they are of several sections or of rubber; and
   !> how many elements have their section.
   subroutine stiffness_of(model, surface, young, elements)
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface
      real(wp), intent(out) :: young
      integer, intent(out) :: elements
      integer :: section, material

      young = 0.0_wp
      elements = 0
      associate (s => model%surface(surface))
         if (.not. allocated(s%element)) return
         if (size(s%element) == 0) return
         section = model%mesh%section(s%element(1))
         if (section == 0) return
         if (any(model%mesh%section(s%element) /= section)) return
      end associate
      material = model%section(section)%material
      if (material == 0) return
      associate (m => model%material(material))
         if (.not. m%has_elastic) return
         young = m%young
      end associate
      elements = count(model%mesh%section == section)
   end subroutine stiffness_of

   !> Where nothing remembers the way, a step has one end whatever its increments.
   subroutine advise_increments(model)
      type(model_type), intent(inout) :: model
      integer :: s, count_of

      if (size(model%pair) > 0) then
         if (any([(has_friction(model%interaction(s)%friction), s=1, &
            & size(model%interaction))])) return
      end if
      if (remembers(model) .or. size(model%spring) > 0) return
      do s = 1, size(model%step)
         associate (step => model%step(s))
            if (step%nlgeom .or. .not. step%timed .or. varies(model, s)) cycle
            if (size(step%pair_change) > 0 .or. size(step%friction_change) > 0) cycle
            if (.not. step%initial < 0.5_wp*step%period) cycle
            count_of = nint(step%period/step%initial)
            call model%log%say(severity%note, 'N0363', 'step '//to_text(s)//' asks for '// &
               & to_text(count_of)//' increments: the scene is elastic, small and without '// &
               & 'friction, its end does not depend on them', step%at, &
               & help='*STATIC without data has the same end in one increment; keep them for '// &
               & 'results on the way')
         end associate
      end do
   end subroutine advise_increments

   !> Whether a material remembers the way: it flows, or is of rubber, whose way is not straight.
   pure logical function remembers(model)
      type(model_type), intent(in) :: model
      integer :: i

      remembers = .false.
      do i = 1, size(model%material)
         associate (m => model%material(i))
            remembers = remembers .or. m%flow%hardening /= 0 .or. m%flow%consistency > 0.0_wp &
               & .or. m%has_neo_hooke .or. allocated(m%plastic) .or. .not. m%has_elastic
         end associate
      end do
   end function remembers

   !> Whether something in a step follows an amplitude: its increments are the user's own.
   pure logical function varies(model, s)
      type(model_type), intent(in) :: model
      integer, intent(in) :: s

      associate (step => model%step(s))
         varies = any(step%prescribed%amplitude > 0) .or. any(step%prescribed%velocity)
         varies = varies .or. any(step%point_load%amplitude > 0) .or. &
            & any(step%face_load%amplitude > 0) .or. any(step%body_load%amplitude > 0)
      end associate
   end function varies
end module lopin_advise
