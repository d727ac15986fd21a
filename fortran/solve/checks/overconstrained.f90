!> Slave nodes that are held twice: by supports along the direction in which contact would act, or
!> by a tie and another pair at once. One message with the node, the pair and the lines of the deck.
module lopin_overconstrained
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_contact_points, only : pair_is_tied
   use lopin_friction, only : has_friction
   use lopin_scene, only : scene_type
   use lopin_repeated_messages, only : warn_once
   implicit none
   private
   public :: report_dependent, refuse_held_penetration

   !> Terms of a row that cancel to this share are gone.
   real(wp), parameter :: cancelled = 1.0e-12_wp
   !> Cosine below which a direction is along the surface.
   real(wp), parameter :: aside = 1.0e-6_wp
   !> Penetration beyond this share of a facet is no rounding.
   real(wp), parameter :: penetrates = 1.0e-6_wp

contains

   !> Why rows of the answer depend on each other, said once for each pair or step.
   subroutine report_dependent(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer :: row, first, number, other, pair

      first = 0
      number = 0
      do row = 1, scene%rows%nnormal
         if (scene%rows%tied(row) .or. .not. scene%answer%active(row)) cycle
         if (.not. is_held(scene, row)) cycle
         number = number + 1
         if (first == 0) first = row
      end do
      if (first > 0) then
         call warn_of_held(scene, model, first, number)
         return
      end if
      do row = 1, scene%rows%nnormal
         if (scene%rows%tied(row) .or. .not. scene%answer%active(row)) cycle
         other = tie_of(scene, model, row)
         if (other == 0) cycle
         pair = pair_of(scene, row)
         call warn_once(scene%log, 'W0409', 'node '//label_of(scene, model, row)// &
            & ' is tied by pair '//name_of(model, other)//' and touches by pair '// &
            & name_of(model, pair)//': both hold it, and how they share the force cannot be told', &
            & model%pair(pair)%at, help='take the node out of the slave surface '// &
            & model%surface(model%pair(pair)%slave)%name//'; the tie is on line '// &
            & to_text(model%pair(other)%at%line))
         return
      end do
      if (scene%answer%dependent <= supported_ties(scene)) return
      call find_between_faces(scene, model, first, other, number)
      if (number > 0) then
         call warn_between_faces(scene, model, first, other, number)
         return
      end if
      if (rubs_along_supports(scene, model%mesh%ndim)) return
      call warn_once(scene%log, 'W0403', to_text(scene%answer%dependent)// &
         & ' contact rows depend on supports or on other rows: their forces are '// &
         & 'shared in the way of least norm', model%step(scene%step)%at, &
         & help='do not fix slave nodes along the contact normal, and list a pair of surfaces once')
   end subroutine report_dependent

   !> Nodes that press the faces of two pairs with friction at once, as in the root of a groove:
   !> what one face bears along itself the other bears along its normal.
   subroutine find_between_faces(scene, model, first, second, number)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(out) :: first, second    !! rows of the first such node; 0: none
      integer, intent(out) :: number           !! of such nodes
      integer :: row_of(model%mesh%nnode), row

      row_of = 0
      first = 0
      second = 0
      number = 0
      do row = 1, scene%rows%nnormal
         if (scene%rows%tied(row) .or. .not. scene%answer%active(row)) cycle
         if (pair_of(scene, row) == 0) cycle
         if (.not. has_friction(model%interaction(model%pair(pair_of(scene, &
            & row))%interaction)%friction)) cycle
         associate (node => scene%points%node(scene%rows%point(row)))
            if (row_of(node) == 0) then
               row_of(node) = row
            else
               number = number + 1
               if (first == 0) second = row
               if (first == 0) first = row_of(node)
            end if
         end associate
      end do
   end subroutine find_between_faces

   subroutine warn_between_faces(scene, model, first, second, number)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: first, second, number
      character(len=:), allocatable :: others

      others = ''
      if (number > 1) others = ' (and '//to_text(number - 1)//' more)'
      associate (one => pair_of(scene, first), two => pair_of(scene, second))
         call warn_once(scene%log, 'W0403', 'node '//label_of(scene, model, first)//others// &
            & ' sticks to the masters of pairs '//name_of(model, one)//' and '// &
            & name_of(model, two)//' at once: what one bears along its face the other bears '// &
            & 'along its normal: the shares are not unique, and the normals bear what they '// &
            & 'can', model%pair(two)%at, help='the sum over both pairs is unique; for shares, '// &
            & 'leave the faces at that edge out of one of the slave surfaces')
      end associate
   end subroutine warn_between_faces

   subroutine warn_of_held(scene, model, row, number)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: row, number
      character(len=:), allocatable :: others

      others = ''
      if (number > 1) others = ' (and '//to_text(number - 1)//' more)'
      call warn_once(scene%log, 'W0409', describe(scene, model, row)//others// &
         & ': what the supports carry there and what contact carries cannot be told apart', &
         & model%pair(pair_of(scene, row))%at, help=remedy(scene, model, row))
   end subroutine warn_of_held

   !> Supports press a held node into its master: nothing can open that.
   subroutine refuse_held_penetration(scene, model, reason, error)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      character(len=*), intent(in) :: reason   !! of the certificate that fails
      type(error_type), allocatable, intent(inout) :: error
      integer :: row

      do row = 1, scene%rows%nnormal
         if (scene%rows%tied(row)) cycle
         associate (gap => scene%answer%gap(row))
            if (.not. -gap > penetrates*scene%points%size(scene%rows%point(row))) cycle
            if (.not. is_held(scene, row)) cycle
            call raise(error, error_code%not_converged, 'E0506', describe(scene, model, row)// &
               & ', and they press it into its master by '//to_text(-gap, 4)// &
               & ': no contact force can open that', model%pair(pair_of(scene, row))%at, &
               & note='certificate: '//reason, help=remedy(scene, model, row))
            return
         end associate
      end do
   end subroutine refuse_held_penetration

   function describe(scene, model, row) result(text)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: row
      character(len=:), allocatable :: text

      text = 'node '//label_of(scene, model, row)//' of pair '// &
         & name_of(model, pair_of(scene, row))//' is overconstrained: supports hold it along '// &
         & 'its contact normal, and the master opposite'
   end function describe

   !> What to change, with the line of the support where there is one.
   function remedy(scene, model, row) result(text)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: row
      character(len=:), allocatable :: text
      integer :: i, direction

      direction = maxloc(abs(scene%rows%direction(:, row)), 1)
      associate (node => scene%points%node(scene%rows%point(row)), &
         & held => model%step(scene%step)%prescribed)
         text = 'let it move along direction '//to_text(direction)
         do i = 1, size(held)
            if (held(i)%node /= node .or. held(i)%dof /= direction) cycle
            text = 'leave out direction '//to_text(direction)//' of its support on line '// &
               & to_text(held(i)%at%line)
            exit
         end do
      end associate
      text = text//', or take it out of the slave surface '// &
         & model%surface(model%pair(pair_of(scene, row))%slave)%name
   end function remedy

   !> Rows along flat ties whose slave node supports hold there, as in a plane of symmetry: they may
   !> depend on each other, and share nothing of the pressure, which has rows of its own.
   pure integer function supported_ties(scene) result(number)
      type(scene_type), intent(in) :: scene
      integer :: row, k, d
      logical :: flat(size(scene%points%first) - 1)

      do k = 1, size(flat)
         associate (n => scene%points%normal(:, scene%points%first(k): &
            & scene%points%first(k + 1) - 1))
            flat(k) = all(maxval(n, 2) - minval(n, 2) <= cancelled)
         end associate
      end do
      d = count(scene%dofs%id(:3, scene%points%node(1)) > 0)
      number = 0
      do row = 1, scene%rows%n
         if (.not. scene%rows%tied(row)) cycle
         if (.not. flat(pair_of(scene, row))) cycle
         associate (point => scene%rows%point(row))
            if (abs(dot_product(scene%rows%direction(:, row), scene%points%normal(:, point))) &
               & > aside) cycle
            if (stays(scene, [(scene%dofs%id(k, scene%points%node(point)), k=1, d)], &
               & scene%rows%direction(:d, row))) number = number + 1
         end associate
      end do
   end function supported_ties

   !> Supports hold a closed point with friction in a direction along its face, as all of a slice in
   !> plane strain: there friction has nothing to bear, and the pressure is unique.
   pure logical function rubs_along_supports(scene, ndim) result(held)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: ndim
      integer :: row, k
      real(wp) :: a(2, 2)
      real(wp), allocatable :: moves(:, :)

      held = .false.
      if (.not. allocated(scene%rows%tangent)) return
      allocate (moves(scene%constraints%neq, ndim - 1))
      do row = 1, scene%rows%nnormal
         if (scene%rows%tangent(row) == 0 .or. .not. scene%answer%active(row)) cycle
         a = 0.0_wp
         do k = 1, ndim - 1
            associate (r => scene%rows, t => scene%rows%tangent(row) + k - 1)
               moves(:, k) = equations_of(scene, r%dof(r%first(t):r%first(t + 1) - 1), &
                  & r%coefficient(r%first(t):r%first(t + 1) - 1))
            end associate
         end do
         a(:ndim - 1, :ndim - 1) = matmul(transpose(moves), moves)
         ! The least eigenvalue beside the largest.
         if (ndim == 2) held = .not. a(1, 1) > aside**2
         if (ndim == 3) held = .not. a(1, 1)*a(2, 2) - a(1, 2)**2 > aside**2*(a(1, 1) + a(2, 2))**2
         if (held) return
      end do
   end function rubs_along_supports

   !> A sum of displacements on the free equations.
   pure function equations_of(scene, dof, coefficient) result(value)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: dof(:)
      real(wp), intent(in) :: coefficient(:)
      real(wp) :: value(scene%constraints%neq)
      integer :: k, c

      value = 0.0_wp
      do k = 1, size(dof)
         do c = scene%constraints%first(dof(k)), scene%constraints%first(dof(k) + 1) - 1
            associate (e => scene%constraints%equation(c))
               if (e > 0) value(e) = value(e) + coefficient(k)*scene%constraints%coefficient(c)
            end associate
         end do
      end do
   end function equations_of

   !> No free equation moves the row.
   pure logical function is_held(scene, row) result(held)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: row

      associate (from => scene%rows%first(row), to => scene%rows%first(row + 1) - 1)
         held = stays(scene, scene%rows%dof(from:to), scene%rows%coefficient(from:to))
      end associate
   end function is_held

   !> No free equation moves a sum of displacements.
   pure logical function stays(scene, dof, coefficient)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: dof(:)
      real(wp), intent(in) :: coefficient(:)
      integer :: k, c
      real(wp) :: most
      integer, allocatable :: equation(:)
      real(wp), allocatable :: value(:)

      allocate (equation(0), value(0))
      do k = 1, size(dof)
         do c = scene%constraints%first(dof(k)), scene%constraints%first(dof(k) + 1) - 1
            equation = [equation, scene%constraints%equation(c)]
            value = [value, coefficient(k)*scene%constraints%coefficient(c)]
         end do
      end do
      most = 0.0_wp
      do k = 1, size(value)
         most = max(most, abs(sum(value, mask=equation == equation(k))))
      end do
      stays = .not. most > cancelled
   end function stays

   !> The pair that ties the node of a row; 0: none.
   pure integer function tie_of(scene, model, row) result(pair)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: row
      integer :: other

      pair = 0
      do other = 1, scene%rows%n
         if (.not. scene%rows%tied(other)) cycle
         if (scene%points%node(scene%rows%point(other)) &
            & /= scene%points%node(scene%rows%point(row))) cycle
         pair = pair_of(scene, other)
         if (pair_is_tied(model, model%pair(pair))) return
      end do
      pair = 0
   end function tie_of

   pure integer function pair_of(scene, row) result(pair)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: row
      pair = scene%points%pair(scene%rows%point(row))
   end function pair_of

   pure function name_of(model, pair) result(name)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      character(len=:), allocatable :: name
      name = '('//model%surface(model%pair(pair)%slave)%name//', '// &
         & model%surface(model%pair(pair)%master)%name//')'
   end function name_of

   pure function label_of(scene, model, row) result(label)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: row
      character(len=:), allocatable :: label
      label = to_text(model%mesh%node_label(scene%points%node(scene%rows%point(row))))
   end function label_of
end module lopin_overconstrained
