!> The long text of each diagnostic code: what happened, why it matters, how to mend it.
!>
!> Every code that the sources raise has an entry; a test reads the sources to make sure.
module lopin_explain
   use lopin_explanation, only : explanation_type
   use lopin_explain_deck, only : deck_explanations
   use lopin_explain_facets, only : facet_explanations
   use lopin_explain_flow, only : flow_explanations
   use lopin_explain_friction, only : friction_explanations
   use lopin_explain_mistakes, only : mistake_explanations
   use lopin_explain_model, only : model_explanations
   use lopin_explain_others, only : other_explanations
   use lopin_explain_run, only : run_explanations
   use lopin_explain_springback, only : springback_explanations
   use lopin_explain_time, only : time_explanations
   use lopin_text, only : upper
   implicit none
   private
   public :: explain, explained_codes

   character(len=1), parameter :: nl = achar(10)
   integer, parameter :: line_width = 92

contains

   !> The explanation of a code as text for the terminal.
   subroutine explain(id, text, found)
      character(len=*), intent(in) :: id                   !! E0312, in any case
      character(len=:), allocatable, intent(out) :: text
      logical, intent(out) :: found
      type(explanation_type), allocatable :: list(:)
      character(len=:), allocatable :: near
      integer :: i

      call all_explanations(list)
      text = 'no diagnostic has the code '//trim(id)
      near = ''
      found = .false.
      do i = 1, size(list)
         if (list(i)%id /= upper(trim(adjustl(id)))) then
            ! 101, or W0101.
            if (list(i)%id(2:) == trailing(id)) near = near//' '//list(i)%id
            cycle
         end if
         text = list(i)%id//': '//list(i)%title//nl//nl//wrapped(list(i)%why)
         if (len(list(i)%cure) > 0) text = text//nl//wrapped('What to do: '//list(i)%cure)
         found = .true.
         return
      end do
      if (len(near) > 0) text = text//'; there is'//near
   end subroutine explain

   !> The number of a code, with its zeros.
   pure function trailing(id) result(digits)
      character(len=*), intent(in) :: id
      character(len=4) :: digits
      integer :: first

      first = scan(id, '0123456789')
      digits = ''
      if (first > 0) digits = repeat('0', max(0, 4 - len_trim(id(first:))))//id(first:)
   end function trailing

   !> All codes with their titles, one a line.
   function explained_codes() result(text)
      character(len=:), allocatable :: text
      type(explanation_type), allocatable :: list(:)
      integer :: i

      call all_explanations(list)
      text = ''
      do i = 1, size(list)
         text = text//list(i)%id//'  '//list(i)%title//nl
      end do
   end function explained_codes

   subroutine all_explanations(list)
      type(explanation_type), allocatable, intent(out) :: list(:)

      allocate (list(0))
      call deck_explanations(list)
      call model_explanations(list)
      call facet_explanations(list)
      call mistake_explanations(list)
      call friction_explanations(list)
      call flow_explanations(list)
      call other_explanations(list)
      call run_explanations(list)
      call springback_explanations(list)
      call time_explanations(list)
   end subroutine all_explanations

   !> Break a paragraph at blanks.
   pure function wrapped(paragraph) result(text)
      character(len=*), intent(in) :: paragraph
      character(len=:), allocatable :: text
      integer :: first, last

      text = ''
      first = 1
      do while (first <= len(paragraph))
         last = len(paragraph)
         if (last - first >= line_width) &
            & last = first - 1 + index(paragraph(first:first + line_width), ' ', back=.true.)
         text = text//trim(paragraph(first:last))//nl
         first = last + 1
      end do
   end function wrapped
end module lopin_explain
